#include "services/status/pace.hpp"

#include <algorithm>

namespace aloft::status {
namespace {

// Flights are stored in bursts, but a gap of ten times the mean is a false alarm only once in thousands.
constexpr int usual_gaps = 10;
constexpr int usual_gaps_waiting = 3;
constexpr std::chrono::seconds least{5};
constexpr std::chrono::seconds least_waiting{2};

}  // namespace

void Pace::update(std::uint64_t stored, bool waits, Clock::time_point now) {
  waits_ = waits;
  if (stored_ == stored) return;
  if (stored_)
    ++changes_;
  else
    first_ = now;
  stored_ = stored;
  changed_ = now;
}

std::optional<Pace::Clock::duration> Pace::blocked_for(Clock::time_point now) const {
  if (!stored_) return std::nullopt;
  const Clock::duration gap =
      changes_ > 0 ? (changed_ - first_) / static_cast<Clock::rep>(changes_) : Clock::duration::zero();
  const Clock::duration limit = waits_ ? std::max<Clock::duration>(least_waiting, usual_gaps_waiting * gap)
                                       : std::max<Clock::duration>(least, usual_gaps * gap);
  const Clock::duration silence = now - changed_;
  return silence > limit ? std::optional(silence) : std::nullopt;
}

}  // namespace aloft::status
