// Runs the built program as a user does.
#pragma once

#include "patina/base/output_file.h"

#include <cstdlib>
#include <filesystem>
#include <string>
#include <sys/wait.h>

namespace patina {

struct ProgramRun {
    int status = -1;  // exit status; -1 when a signal ended it
    std::string output;
    std::string errors;
};

// arguments: as in a shell. folder: where what it prints is kept; exists.
[[nodiscard]] inline ProgramRun run_program(const std::string& arguments,
                                            const std::filesystem::path& folder) {
    const std::filesystem::path output = folder / "stdout.txt";
    const std::filesystem::path errors = folder / "stderr.txt";
    const std::string command = "'" PATINA_PROGRAM "' " + arguments + " >'" + output.string() +
                                "' 2>'" + errors.string() + "' </dev/null";
    const int code = std::system(command.c_str());
    return {WIFEXITED(code) ? WEXITSTATUS(code) : -1, read_file(output), read_file(errors)};
}

}  // namespace patina
