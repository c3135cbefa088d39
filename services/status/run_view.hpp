#pragma once

#include <chrono>
#include <deque>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "common/bus/wire.hpp"
#include "services/status/pace.hpp"

namespace aloft::status {

using Clock = std::chrono::steady_clock;

/// A process that is silent for longer is lost.
inline constexpr double lost_after_s = 3.0;

/// A run as its status messages show it, and which processes have been silent for how long. No bus; the clock is passed
/// in.
class RunView {
 public:
  /// `name`: the run's name on the bus.
  explicit RunView(std::string name) : name_(std::move(name)) {}

  void hear(const wire::RunControl& control, Clock::time_point now);
  void hear(const wire::RunStatus& status, Clock::time_point now);
  void hear(const wire::WorkerStatus& status, Clock::time_point now);
  void hear(const wire::CollectorStatus& status, Clock::time_point now);
  /// The middleware of the processes of the run (bus::Participant::middleware_of).
  void on_middleware(std::vector<std::string> names) { middleware_ = std::move(names); }
  /// Forgets workers that left 10 s ago, and those that have been lost for 10 minutes.
  void forget_old(Clock::time_point now);

  /// True once the coordinator, the collector, and as many workers as the coordinator knows, have been heard.
  [[nodiscard]] bool complete() const;
  [[nodiscard]] bool heard() const noexcept { return run_.has_value() || !workers_.empty(); }

  /// docs/status.md shows an example and says what each field means.
  [[nodiscard]] nlohmann::ordered_json to_json(Clock::time_point now) const;

 private:
  struct Count {
    Clock::time_point at;
    std::uint64_t flights;
    std::uint64_t steps;
  };
  struct Worker {
    wire::WorkerStatus status;
    Clock::time_point heard;
    std::deque<Count> counts;  ///< of the last seconds, for the rates
  };
  [[nodiscard]] static nlohmann::ordered_json to_json(const Worker& worker, Clock::time_point now);

  std::string name_;
  std::string experiment_;
  std::vector<std::string> middleware_;
  std::optional<wire::RunStatus> run_;
  Pace pace_;
  Clock::time_point run_heard_;
  std::optional<wire::CollectorStatus> collector_;
  std::map<std::string, Worker> workers_;
};

/// The result of RunView::to_json() for people, in lines of at most `width` columns: a table of the workers, then the
/// problems.
[[nodiscard]] std::string run_text(const nlohmann::ordered_json& run, std::size_t width);
/// The same in one line.
[[nodiscard]] std::string run_line(const nlohmann::ordered_json& run);
/// 75 -> "1:15", 3700 -> "1:01:40".
[[nodiscard]] std::string clock_text(double seconds);

}  // namespace aloft::status
