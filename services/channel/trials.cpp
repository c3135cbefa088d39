#include "services/channel/trials.hpp"

#include <algorithm>
#include <utility>

namespace aloft::channel {
namespace {

constexpr std::size_t max_past = 1024;

}  // namespace

Trial& Trials::add(std::uint64_t lease_id, std::uint32_t condition, std::uint32_t trial,
                   std::vector<std::string> agents) {
  Trial& added = trials_.emplace_back();
  added.lease_id = lease_id;
  added.condition = condition;
  added.trial = trial;
  added.waiting = std::move(agents);
  return added;
}

Trial* Trials::find(std::uint64_t lease_id) {
  const auto at = std::ranges::find(trials_, lease_id, &Trial::lease_id);
  return at == trials_.end() ? nullptr : &*at;
}

bool Trials::knows(std::uint64_t lease_id) const {
  return std::ranges::find(trials_, lease_id, &Trial::lease_id) != trials_.end() ||
         std::ranges::find(past_, lease_id) != past_.end();
}

void Trials::remove(std::uint64_t lease_id) {
  past_.push_front(lease_id);
  if (past_.size() > max_past) past_.pop_back();
  if (Trial* trial = find(lease_id)) give_back(*trial);
  trials_.remove_if([&](const Trial& trial) { return trial.lease_id == lease_id; });
}

bool Trials::take_lane(Trial& trial) {
  const auto free = std::ranges::find(lane_taken_, false);
  if (free == lane_taken_.end()) return false;
  *free = true;
  trial.lane = static_cast<int>(free - lane_taken_.begin());
  return true;
}

void Trials::give_back(Trial& trial) {
  if (trial.lane >= 0) lane_taken_[static_cast<std::size_t>(trial.lane)] = false;
  trial.lane = -1;
  trial.map.reset();
}

std::size_t Trials::waiting_for_storage() const {
  return static_cast<std::size_t>(std::ranges::count_if(trials_, &Trial::flown));
}

}  // namespace aloft::channel
