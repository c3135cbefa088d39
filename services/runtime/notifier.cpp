#include "services/runtime/notifier.hpp"

#include <systemd/sd-daemon.h>

#include <cstdint>

namespace aloft::runtime {
namespace {

constexpr int pings_per_period = 4;

}  // namespace

Notifier::Notifier(bool is_child) : is_child_(is_child) {
  std::uint64_t period_us = 0;
  if (sd_watchdog_enabled(0, &period_us) > 0) watchdog_period_ = std::chrono::microseconds(period_us);
}

Notifier::~Notifier() {
  send("STOPPING=1");
}

void Notifier::ready(const std::string& status) {
  send("READY=1\nSTATUS=" + status);
  alive();
}

void Notifier::alive() {
  const auto now = Clock::now();
  if (watchdog_period_ == Clock::duration::zero() || now - told_ < watchdog_period_ / pings_per_period) return;
  told_ = now;
  send("WATCHDOG=1");
}

void Notifier::send(const std::string& message) const {
  if (!is_child_) sd_notify(0, message.c_str());  // without a manager, this fails and does no harm
}

}  // namespace aloft::runtime
