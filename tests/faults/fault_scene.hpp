#pragma once

#include <chrono>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "tests/integration/command.hpp"

namespace aloft::test {

/// Sets an environment variable for the processes that are started as long as it lives.
class Variable {
 public:
  Variable(const char* name, const std::string& value);
  ~Variable();
  Variable(const Variable&) = delete;
  Variable& operator=(const Variable&) = delete;

 private:
  const char* name_;
};

/// One small experiment with agents of every kind, flown in process for reference, and runs of it over DDS for tests of
/// faults.
class FaultScene {
 public:
  /// `trials` per condition; there are two conditions and six agents, one of which remembers earlier trials.
  explicit FaultScene(int trials = 8);

  [[nodiscard]] std::filesystem::path out(const std::string& name) const { return scratch_ / name; }
  [[nodiscard]] std::filesystem::path experiment() const { return scratch_ / "experiment.json"; }
  [[nodiscard]] int flights() const { return 2 * 7 * trials_; }
  /// Digest of the flights in process.
  [[nodiscard]] const std::string& reference() const { return reference_; }

  /// Starts aloft run with the result folder out(name).
  [[nodiscard]] std::vector<std::string> run_arguments(const std::string& name,
                                                       const std::vector<std::string>& options) const;
  [[nodiscard]] std::unique_ptr<Command> start(const std::string& name, const std::vector<std::string>& options) const;
  [[nodiscard]] std::string digest(const std::string& name) const;
  /// Number of flights in the database; 0 if there is none yet.
  [[nodiscard]] int stored(const std::string& name) const;
  /// Waits until so many flights are stored or the command ends.
  void wait_for_flights(const std::string& name, Command& run, int flights) const;
  /// The services of a run: all processes for out(name), other than the command itself, whose command line contains
  /// `part`.
  [[nodiscard]] std::vector<int> services(const std::string& name, const Command& run,
                                          const std::string& part = "") const;
  [[nodiscard]] std::string log(const std::string& name, const std::string& process) const;
  /// Checks that the run ends with exit code 0, the same bytes as in process, and no process left.
  void check_finished(const std::string& name, Command& run, std::chrono::seconds limit) const;

 private:
  ScratchDir scratch_;
  int trials_;
  std::string reference_;
};

/// A name that no other run on this machine has.
[[nodiscard]] std::string own_name(const std::string& what);
/// Resident memory of a process in bytes; 0 if it is gone.
[[nodiscard]] std::size_t resident_bytes(int pid);
[[nodiscard]] std::string command_line(int pid);

/// No attack may make a process grow by so much.
inline constexpr std::size_t allowed_growth_bytes = 10U << 20U;
/// Whether resident memory tells what a process holds: sanitizers keep freed memory for a while.
inline constexpr bool memory_tells = slowdown == 1;

/// Holds a run up by stopping its environments: without worlds it waits, and what grows meanwhile grows because of an
/// attack.
class HeldRun {
 public:
  HeldRun(const FaultScene& scene, std::string name, const Command& run);

  /// Checks that no process has ended, or has grown by more than is allowed since the last call or the beginning.
  void check_growth(const char* attack);
  void go_on() const;

 private:
  void send_environments(int signal) const;

  const FaultScene& scene_;
  std::string name_;
  const Command& run_;
  std::map<int, std::size_t> bytes_;  // by process
};
/// Calls `done` every few milliseconds until it is true; false after `limit` (times the slowdown).
bool eventually(std::chrono::seconds limit, const std::function<bool()>& done);

}  // namespace aloft::test
