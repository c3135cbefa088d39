#pragma once

#include <chrono>
#include <mutex>
#include <string>
#include <vector>

#include "services/http/http_server.hpp"
#include "services/status/run_view.hpp"

namespace aloft::metrics {

/// The latest status messages of the run, for HTTP. Thread-safe: the collector writes, the server reads.
class StatusBoard {
 public:
  using Clock = std::chrono::steady_clock;

  /// `run`: its name on the bus.
  explicit StatusBoard(std::string run) : view_(std::move(run)) {}

  /// A message that RunView::hear() takes.
  template <typename Message>
  void hear(const Message& message) {
    const std::lock_guard lock(mutex_);
    view_.hear(message, Clock::now());
  }
  void on_middleware(std::vector<std::string> names);
  /// From the collector's loop; `paused` says why nothing can be stored, or is empty.
  void on_tick(Clock::time_point now, const std::string& paused);

  /// As `aloft status --format json` gives it: see RunView::to_json().
  [[nodiscard]] std::string status_json() const;
  /// 503 if the collector's loop has stood still for 10 s.
  [[nodiscard]] http::HttpResponse health(Clock::time_point now) const;

 private:
  mutable std::mutex mutex_;
  status::RunView view_;
  mutable std::mutex health_mutex_;  // of its own, so that a health check never waits for a long status
  std::string paused_;
  Clock::time_point ticked_ = Clock::now();
};

}  // namespace aloft::metrics
