#include "patina/base/error.h"

#include <atomic>
#include <csignal>

namespace patina {
namespace {

// A signal handler can reach nothing but static state; this flag is the project's only one.
volatile std::sig_atomic_t interrupted = 0;

extern "C" void on_interrupt(int signal_number) {
    interrupted = 1;
    std::signal(signal_number, SIG_DFL);
}

std::string error_line(const std::string& place,
                       const std::string& field,
                       const std::string& problem,
                       const std::string& expected) {
    std::string line = place;
    if (!field.empty()) line += ": " + field;
    line += ": " + problem;
    if (!expected.empty()) line += " (expected " + expected + ")";
    return line;
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
