#include "patina/base/error.h"

#include <algorithm>
#include <csignal>

namespace patina {
namespace {

// A signal handler can reach nothing but static state; this flag is the project's only one.
volatile std::sig_atomic_t interrupted = 0;

extern "C" void on_interrupt(int signal_number) {
    interrupted = 1;
    std::signal(signal_number, SIG_DFL);
}

// Names and pieces of files may hold anything; an error is one line that no terminal obeys.
std::string without_control_characters(std::string line) {
    const auto is_control = [](unsigned char c) { return c < 0x20 || c == 0x7f; };
    std::replace_if(line.begin(), line.end(), is_control, '?');
    return line;
}

std::string error_line(const std::string& place,
                       const std::string& field,
                       const std::string& problem,
                       const std::string& expected) {
    std::string line = place;
    if (!field.empty()) line += ": " + field;
    line += ": " + problem;
    if (!expected.empty()) line += " (expected " + expected + ")";
    return without_control_characters(line);
}

}  // namespace

Error::Error(const std::string& place,
             const std::string& field,
             const std::string& problem,
             const std::string& expected)
    : std::runtime_error(error_line(place, field, problem, expected)) {}

Interrupted::Interrupted() : std::runtime_error("stopped by the user; nothing was written") {}

void install_interrupt_handler() {
    std::signal(SIGINT, on_interrupt);
    std::signal(SIGTERM, on_interrupt);
}

void throw_if_interrupted() {
    if (interrupted != 0) throw Interrupted();
}

}  // namespace patina
