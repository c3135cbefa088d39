#include "services/status/run_observer.hpp"

namespace aloft::status {

RunObserver::RunObserver(const bus::BusOptions& place) : participant_(place), view_(place.run) {}

void RunObserver::listen() {
  const auto now = Clock::now();
  const auto hear = [&](const auto& message) { view_.hear(message, now); };
  controls_.drain(hear);
  runs_.drain(hear);
  workers_.drain(hear);
  collectors_.drain(hear);
  view_.on_middleware(participant_.middleware_of(participant_.options().run));
  view_.forget_old(now);
}

}  // namespace aloft::status
