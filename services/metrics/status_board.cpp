#include "services/metrics/status_board.hpp"

namespace aloft::metrics {
namespace {

constexpr auto stalled_after = std::chrono::seconds(10);

}  // namespace

void StatusBoard::on_middleware(std::vector<std::string> names) {
  const std::lock_guard lock(mutex_);
  view_.on_middleware(std::move(names));
}

void StatusBoard::on_tick(Clock::time_point now, const std::string& paused) {
  {
    const std::lock_guard lock(health_mutex_);
    ticked_ = now;
    paused_ = paused;
  }
  const std::lock_guard lock(mutex_);
  view_.forget_old(now);
}

std::string StatusBoard::status_json() const {
  const std::lock_guard lock(mutex_);
  return view_.to_json(Clock::now()).dump(2, ' ', true, nlohmann::json::error_handler_t::replace) + "\n";
}

http::HttpResponse StatusBoard::health(Clock::time_point now) const {
  const std::lock_guard lock(health_mutex_);
  if (now - ticked_ > stalled_after) return {503, "text/plain", "the collector stands still\n"};
  return {200, "text/plain", paused_.empty() ? "ok\n" : paused_ + "\n"};
}

}  // namespace aloft::metrics
