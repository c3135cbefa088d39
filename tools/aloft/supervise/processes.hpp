#pragma once

#include <chrono>
#include <deque>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "common/base/cores.hpp"
#include "common/bus/participant.hpp"
#include "tools/aloft/supervise/children.hpp"

namespace aloft::cli {

/// The path of another program of this build.
[[nodiscard]] std::filesystem::path program_path(const std::string& program);

/// Services that belong together on this machine: started, started again when they die, and ended together.
class Processes {
 public:
  /// All take the same place on the bus, and write their logs into `log_dir`, which is made when they are started.
  Processes(bus::BusOptions place, std::filesystem::path log_dir);

  /// A service by the name of its program, and its further arguments. `worker`: whose process it is, if any.
  void add(const std::string& program, const std::vector<std::string>& more, const std::string& worker = "",
           const CoreShare& cores = {});
  /// A service that decides when all is over: it is not started again when it ends by itself.
  void add_decider(const std::string& program, const std::vector<std::string>& more);
  /// The four processes of a worker that learns in so many threads and flies only these agents; none named: all. They
  /// talk to each other all the time, which costs least on cores of their own.
  void add_worker(const std::string& worker, unsigned learner_threads, const std::vector<std::string>& agents = {},
                  const CoreShare& cores = {});
  void start_all();

  /// Restarts processes that died and returns a line for each. A process that ends with exit code 0 has received the
  /// end of the run; it is restarted only if the others do not end within 3 s. std::runtime_error if a process dies too
  /// often.
  std::vector<std::string> supervise();
  /// The exit code of the decider, once it has ended by itself.
  [[nodiscard]] std::optional<int> decision() const noexcept { return decision_; }
  /// All processes have ended with exit code 0.
  [[nodiscard]] bool all_left() const noexcept { return children_.empty(); }

  /// Ends all. Returns the names of processes that had to be killed.
  std::vector<std::string> stop(std::chrono::milliseconds limit) { return children_.stop_all(limit); }

 private:
  using Clock = std::chrono::steady_clock;
  struct Command {
    std::string name;
    std::vector<std::string> arguments;
    CoreShare cores;
  };
  [[nodiscard]] std::filesystem::path log_of(const std::string& name) const { return log_dir_ / (name + ".log"); }
  void start(const std::string& name);
  void start_again(const std::string& name);

  bus::BusOptions place_;
  std::filesystem::path log_dir_;
  std::string decider_;
  std::optional<int> decision_;
  std::vector<Command> commands_;
  std::map<std::string, std::deque<Clock::time_point>> restarts_;
  std::vector<std::pair<Children::Ended, Clock::time_point>> left_;
  Children children_;
};

}  // namespace aloft::cli
