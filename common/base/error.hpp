#pragma once

#include <stdexcept>
#include <string>

namespace aloft {

/// The user's input (a file, an option, an environment) cannot be used. The message says what, where, the allowed
/// range and what to do next; programs print it and exit with code 2 before anything is written.
class InputError : public std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// Stored data contradict themselves (a digest that does not match, a truncated file). Programs stop.
class IntegrityError : public std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// Exit codes of every program.
enum ExitCode : int { exit_ok = 0, exit_failure = 1, exit_bad_input = 2, exit_interrupted = 130 };

}  // namespace aloft
