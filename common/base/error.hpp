#pragma once

#include <fmt/format.h>

#include <stdexcept>
#include <utility>

namespace aloft {

/// An error whose message can be given as to fmt::format.
class FormattedError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
  template <typename... Values>
  explicit FormattedError(fmt::format_string<Values...> message, Values&&... values)
      : runtime_error(fmt::format(message, std::forward<Values>(values)...)) {}
};

/// The user's input (a file, an option, an environment) cannot be used. The message says what, where, the allowed
/// range and what to do next; programs print it and exit with code 2 before anything is written.
class InputError : public FormattedError {
  using FormattedError::FormattedError;
};

/// Stored data contradict themselves (a digest that does not match, a truncated file). Programs stop.
class IntegrityError : public FormattedError {
  using FormattedError::FormattedError;
};

/// Exit codes of every program.
enum ExitCode : int { exit_ok = 0, exit_failure = 1, exit_bad_input = 2, exit_interrupted = 130 };

}  // namespace aloft
