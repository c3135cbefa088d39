#pragma once

#include <chrono>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "tests/integration/command.hpp"

namespace aloft::test {

/// A run that the test puts together from single processes, in a domain and a result folder of its own.
class SpreadRun {
 public:
  /// `trials` of 2 conditions with a learning and two other agents: about 0.2 s of one core each.
  explicit SpreadRun(int trials);

  /// The digest of the flights in process, which all others must equal.
  [[nodiscard]] const std::string& expected_digest();
  [[nodiscard]] std::string digest() const;
  [[nodiscard]] std::string flights_stored() const;

  /// `prefix` stands before the program, e.g. {"/usr/sbin/ip", "netns", "exec", "a"}, and `more` after its arguments.
  std::unique_ptr<Command> start(const std::string& command, std::vector<std::string> more = {},
                                 std::vector<std::string> prefix = {}) const;
  std::unique_ptr<Command> coordinator(const std::vector<std::string>& more = {}) const;
  std::unique_ptr<Command> metrics(const std::vector<std::string>& more = {}) const;
  std::unique_ptr<Command> worker(const std::string& name, const std::vector<std::string>& more = {}) const;

  [[nodiscard]] std::string experiment() const { return (scratch_ / "experiment.json").string(); }
  [[nodiscard]] std::string out() const { return (scratch_ / "out").string(); }
  [[nodiscard]] const std::string& name() const noexcept { return name_; }
  /// The log of a service of the result folder's machine.
  [[nodiscard]] std::string log(const std::string& program) const {
    return read_text(scratch_ / "out" / "log" / (program + ".log"));
  }
  [[nodiscard]] std::filesystem::path scratch(const std::string& file) const { return scratch_ / file; }

 private:
  ScratchDir scratch_;
  std::string name_;
  std::string expected_;
};

/// False if `condition` has not come true within `limit` (times the slowdown).
[[nodiscard]] bool comes_true(const std::function<bool()>& condition, std::chrono::milliseconds limit);

}  // namespace aloft::test
