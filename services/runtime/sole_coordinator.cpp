#include "services/runtime/sole_coordinator.hpp"

#include <fmt/format.h>

#include <thread>
#include <utility>

#include "common/base/error.hpp"
#include "common/base/plain_text.hpp"
#include "common/bus/convert.hpp"

namespace aloft::runtime {
namespace {

using Clock = std::chrono::steady_clock;

// Time for the process that has the claim to identify itself, or to end.
constexpr std::chrono::seconds patience{15};
constexpr std::chrono::milliseconds poll_period{20};

}  // namespace

SoleCoordinator::SoleCoordinator(const bus::Participant& participant)
    : run_(participant.options().run), controls_(participant) {}

bool SoleCoordinator::take(RunClaim& claim, std::chrono::milliseconds quiet, const std::function<bool()>& stopped) {
  const auto start = Clock::now();
  while (!stopped()) {
    if (const auto other = hear()) throw InputError(refusal(*other));
    const auto waited = Clock::now() - start;
    const bool ours = claim.take();
    if (ours && waited >= quiet) return true;
    if (!ours && waited >= patience)
      throw InputError(
          "another process of this machine coordinates run '{}' and does not say who it is; wait for it, "
          "end it, or use another --run",
          run_);
    std::this_thread::sleep_for(poll_period);
  }
  return false;
}

std::optional<ProcessName> SoleCoordinator::hear() {
  std::optional<ProcessName> other;
  controls_.drain([&](const wire::RunControl& control) {
    ProcessName from = bus::from_wire(control.coordinator());
    const bool goes_on = control.state() == wire::RUN_RUNNING;
    if (goes_on && from.known() && from.incarnation != this_process().incarnation) other = std::move(from);
  });
  return other;
}

bool SoleCoordinator::is_first(const ProcessName& self, const ProcessName& other) noexcept {
  return std::pair(self.since_s, self.incarnation) < std::pair(other.since_s, other.incarnation);
}

std::string SoleCoordinator::refusal(const ProcessName& first) const {
  return fmt::format(
      "run '{0}' has a coordinator already: {1}; join it with: aloft worker --join {0}, or use another --run", run_,
      plain_text(to_text(first, "aloft-coordinator")));
}

}  // namespace aloft::runtime
