// The two ways in which a command ends badly: bad input (exit status 2) and work that failed (1).
#pragma once

#include <stdexcept>
#include <string>

namespace patina {

// Bad input or bad words. what() is "FILE: FIELD: what is wrong (what was expected)", without the
// leading "patina: " which the command line adds: always one line, control characters replaced.
class Error : public std::runtime_error {
  public:
    // place: a file, a folder or an option. field: a path such as "lights[2].intensity"; empty when
    // the file as a whole is meant. expected: may be empty.
    Error(const std::string& place,
          const std::string& field,
          const std::string& problem,
          const std::string& expected);
};

// The input was right, but the work could not be done: disk full, out of memory.
class WorkFailed : public std::runtime_error {
  public:
    using std::runtime_error::runtime_error;
};

// The user asked to stop (Ctrl-C). Thrown by throw_if_interrupted() between units of work.
class Interrupted : public std::runtime_error {
  public:
    Interrupted();
};

// Routes Ctrl-C and SIGTERM to a flag instead of ending the process at once; a second Ctrl-C ends
// it.
void install_interrupt_handler();

// Throws Interrupted once the flag is set. Cheap; called once per block of work, never per texel.
void throw_if_interrupted();

}  // namespace patina
