// A capture that takes no time: object A, 16 x 16 texels, four lamps, made by the program itself.
#pragma once

#include <gtest/gtest.h>

#include "support/program.h"
#include <filesystem>
#include <string>

namespace patina {

inline constexpr const char* kTinyScan =
    "simulate A --texels 16x16 --samples 4 --lights 12,25,42,55 --quiet";

// The capture's folder, in quotes for a shell.
[[nodiscard]] inline std::string make_tiny_capture(const std::filesystem::path& folder) {
    const std::string capture = "'" + (folder / "capture").string() + "'";
    const ProgramRun run = run_program(std::string(kTinyScan) + " -o " + capture, folder);
    EXPECT_EQ(run.status, 0) << run.errors;
    return capture;
}

}  // namespace patina
