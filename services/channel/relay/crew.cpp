#include "services/channel/relay/crew.hpp"

#include <algorithm>
#include <utility>

#include "common/agents/relay.hpp"

namespace aloft::channel {
namespace {

// Somewhat more than the liveliness lease of commands (common/bus): until then, the pilot may just be slow.
constexpr std::chrono::milliseconds takeover_after{550};
constexpr std::chrono::seconds follow_limit{1};

}  // namespace

Crew::Crew(const agents::AgentSpec& relay, bool failover, Clock::time_point now)
    : relay_(relay), failover_(failover), members_(relay.crew.size()), asked_at_(now) {
  begin_step(1, now);
}

std::size_t Crew::find(std::string_view name) const noexcept {
  const auto at = std::ranges::find(
      relay_.crew, name, [](const agents::CrewMember& member) -> std::string_view { return member.agent.name; });
  return static_cast<std::size_t>(at - relay_.crew.begin());
}

bool Crew::do_without(const std::vector<std::string>& absent, Clock::time_point now) {
  if (!failover_) return false;
  for (const std::string& name : absent)
    if (const std::size_t index = find(name); index < members_.size()) members_[index].absent = true;
  return ask(pilot_, now);
}

void Crew::comes(std::string_view name) {
  const std::size_t index = find(name);
  if (index == members_.size() || !std::exchange(members_[index].absent, false)) return;
  members_[index].left = true;
}

bool Crew::at_hand(std::size_t index) const noexcept {
  const Member& member = members_[index];
  return member.aboard && !member.absent && !member.left && !member.failed;
}

std::size_t Crew::present(std::size_t index) const noexcept {
  if (!members_[index].absent) return index;
  if (at_hand(pilot_)) return pilot_;  // the present pilot goes on
  for (std::size_t i = 0; i < members_.size(); ++i)
    if (at_hand(i)) return i;
  return index;
}

bool Crew::ask(std::size_t index, Clock::time_point now) {
  index = present(index);
  asked_at_ = now;
  members_[index].aboard = true;
  members_[index].left = false;
  if (index == pilot_) return false;
  pilot_ = index;
  return true;
}

bool Crew::begin_step(std::uint32_t step, Clock::time_point now) {
  for (std::size_t i = 0; i < members_.size(); ++i) {
    members_[i].followed = members_[i].failed = false;
    if (relay_.crew[i].boards_at() == step - 1) members_[i].aboard = true;
  }
  return ask(appoint(step), now);
}

std::size_t Crew::appoint(std::uint32_t step) {
  if (order_ && step >= order_->from_step) {
    const bool takes_effect = !std::exchange(order_in_effect_, true);
    return takes_effect ? find(order_->agent) : pilot_;
  }
  const std::size_t written = agents::written_pilot(relay_.crew, step);
  return relay_.crew[written].from_step == step ? written : pilot_;  // in between, a member that took over goes on
}

bool Crew::order(const SwapOrder& order, std::uint32_t step, Clock::time_point now) {
  order_ = order;
  order_in_effect_ = false;
  order_open_ = true;
  return step >= order.from_step && ask(appoint(step), now);
}

bool Crew::admit(std::string_view name, Clock::time_point now) {
  const std::size_t index = find(name);
  if (index == members_.size()) return false;
  if (index == pilot_) return true;
  if (!failover_ || now - asked_at_ < takeover_after) return false;
  members_[pilot_].left = true;
  members_[index].absent = false;
  ask(index, now);
  return true;
}

bool Crew::pass_on(Clock::time_point now) {
  if (!failover_) return false;
  members_[pilot_].failed = true;
  for (std::size_t i = 0; i < members_.size(); ++i)
    if (at_hand(i)) return ask(i, now);
  return false;
}

void Crew::executed() noexcept {
  if (order_in_effect_ && pilot().name == order_->agent) order_open_ = false;
}

void Crew::followed(std::string_view name) {
  const std::size_t index = find(name);
  if (index == members_.size()) return;
  members_[index].followed = members_[index].aboard = true;
  members_[index].left = members_[index].absent = false;
}

bool Crew::is_behind(std::size_t index) const noexcept {
  const Member& member = members_[index];
  const bool silent = agents::agent_type(agent(index).type).foreign;  // answers only reports that ask it
  return index != pilot_ && member.aboard && !member.absent && !member.left && !member.followed && !silent;
}

bool Crew::all_followed() const {
  for (std::size_t i = 0; i < members_.size(); ++i)
    if (is_behind(i)) return false;
  return true;
}

void Crew::leave_behind(Clock::time_point now) {
  if (!failover_ || now - asked_at_ < follow_limit) return;
  for (Member& member : members_) member.left = member.left || !member.followed;
  members_[pilot_].left = false;
}

std::vector<std::string_view> Crew::behind() const {
  std::vector<std::string_view> names;
  for (std::size_t i = 0; i < members_.size(); ++i)
    if (is_behind(i)) names.push_back(agent(i).name);
  return names;
}

}  // namespace aloft::channel
