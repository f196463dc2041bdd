// The verbs of the program: their words, their help, and which function of the library each calls.
#pragma once

#include "patina/pipeline/options.h"

#include <functional>
#include <memory>
#include <string>
#include <vector>

namespace patina {

// Options that every verb has.
struct CommonOptions {
    std::uint64_t seed = 1;
    int threads = 0;  // 0: all
    bool quiet = false;
    bool json = false;
};

// One verb. `run` does the work with what the options hold, prints the result on standard output
// and throws when it cannot.
struct Command {
    std::string name;
    std::string summary;  // one sentence without a full stop
    std::string example;  // a whole command line
    OptionTable options;  // positional words first
    std::function<void()> run;
    std::shared_ptr<void> state;  // what the options point into
};

[[nodiscard]] std::vector<Command> all_commands();

// Verbs that the documentation names but this version does not have yet.
[[nodiscard]] std::vector<std::string> later_commands();

// The tables of docs/commands.md.
[[nodiscard]] std::string commands_markdown();

}  // namespace patina
