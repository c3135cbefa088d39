#include "common/bus/waiter.hpp"

#include <fastdds/dds/core/condition/GuardCondition.hpp>
#include <fastdds/dds/core/condition/WaitSet.hpp>
#include <stdexcept>

#include "common/bus/detail.hpp"
#include "common/bus/middleware/duration.hpp"

namespace aloft::bus {

struct Waiter::State {
  dds::WaitSet waits;
  dds::GuardCondition guard;
  dds::ConditionSeq active;
};

Waiter::Waiter() : state_(std::make_unique<State>()) {
  attach(&state_->guard);
}

Waiter::Waiter(StopSignal& stop) : Waiter() {
  ticket_ = stop.on_request([this] { wake(); });
}

Waiter::~Waiter() = default;

void Waiter::attach(void* condition) {
  if (!succeeded(state_->waits.attach_condition(*static_cast<dds::Condition*>(condition))))
    throw std::logic_error("bus: cannot attach a condition to a wait set");
}

bool Waiter::wait(std::chrono::milliseconds limit) {
  const bool woken = succeeded(state_->waits.wait(state_->active, duration(limit)));
  state_->guard.set_trigger_value(false);
  return woken;
}

void Waiter::wake() {
  state_->guard.set_trigger_value(true);
}

}  // namespace aloft::bus
