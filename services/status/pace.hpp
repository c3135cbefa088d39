#pragma once

#include <chrono>
#include <cstdint>
#include <optional>

namespace aloft::status {

/// Whether a run makes progress, from how often flights are stored. The clock is passed in.
class Pace {
 public:
  using Clock = std::chrono::steady_clock;

  /// `stored`: flights so far; `waits`: the run says that it waits for something.
  void update(std::uint64_t stored, bool waits, Clock::time_point now);

  /// For how long nothing has been stored, if that is much longer than usual: then the rate so far does not tell how
  /// much time is left.
  [[nodiscard]] std::optional<Clock::duration> blocked_for(Clock::time_point now) const;

 private:
  std::optional<std::uint64_t> stored_;
  std::uint64_t changes_ = 0;
  bool waits_ = false;
  Clock::time_point first_;
  Clock::time_point changed_;
};

}  // namespace aloft::status
