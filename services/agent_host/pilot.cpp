#include "services/agent_host/pilot.hpp"

#include <exception>
#include <utility>

#include "common/bus/convert.hpp"

namespace aloft::agent_host {
namespace {

constexpr std::size_t max_kept = 8;

}  // namespace

void Task::run() noexcept try {
  if (begins) {
    agent = spec->make();
    if (!memory.empty()) agent->restore_state(memory);
    memory.clear();
    agent->begin(*begins);
  }
  if (map) agent->survey(*map);
  for (const agents::HeightProfile& profile : profiles) agent->foresee(profile);
  agent->observe(observation);
  if (!observation.last)
    command = agent->act();
  else if (spec->lineages() > 0)
    memory = agent->save_state();
} catch (const std::exception& failure) {
  error = failure.what();
} catch (...) {
  error = "unknown exception";
}

Pilot::Pilot(const agents::AgentSpec& spec, std::uint32_t stream, Boarding boarding)
    : spec_(spec), type_(agents::agent_type(spec.type)), boarding_(boarding) {
  task_.spec = &spec;
  answer_.stream(stream);
  answer_.agent(wire::name(spec.name));
  handed_over_.stream(stream);
  handed_over_.agent(wire::name(spec.name));
}

Pilot::Verdict Pilot::offer(const wire::ChannelReport& report) {
  if (known_ && older(report.attempt(), attempt_)) return Verdict::nothing;
  const bool same = aboard(report);
  if (thinking_) {
    if (!same) keep(report);
    return Verdict::nothing;
  }
  if (same && report.step() < expected_) return repeat(report);
  const bool follows = same && report.step() == expected_;
  const bool begins = !follows && boards_at(report.step());
  if (!follows && !begins) return report.step() < boarding_.first_step ? Verdict::nothing : unknown(report);
  const bool remembers = !begins || recall(report);
  if (!remembers || !map_there(report, begins) || !profiles_complete(report)) {
    keep(report);
    return Verdict::nothing;
  }
  return think(report, begins);
}

Pilot::Verdict Pilot::resume() {
  std::vector<wire::ChannelReport> reports;
  reports.swap(kept_);
  for (auto report = reports.begin(); report != reports.end(); ++report) {
    const Verdict verdict = offer(*report);
    if (verdict == Verdict::nothing) continue;
    kept_.insert(kept_.end(), std::make_move_iterator(report + 1), std::make_move_iterator(reports.end()));
    return verdict;
  }
  return Verdict::nothing;
}

bool Pilot::boards_at(std::uint32_t step) const noexcept {
  return boarding_.late ? step >= boarding_.first_step : step == boarding_.first_step;
}

void Pilot::survey(const wire::SiteMap& message) {
  if (map_ && older(message.attempt(), map_attempt_)) return;
  if (known_ && (older(message.attempt(), attempt_) || (message.attempt() == attempt_ && message.step() < expected_)))
    return;  // the report that needed it has been handled
  const bool whole_is_here = map_ && map_attempt_ == message.attempt() && map_->step == message.step() && map_->radio;
  if (whole_is_here) return;
  map_ = bus::site_map(message);
  map_attempt_ = message.attempt();
}

bool Pilot::map_there(const wire::ChannelReport& report, bool begins) const {
  if (type_.privilege != agents::Privilege::site_map || report.last() || (!begins && !route_in_parts_)) return true;
  return map_ && map_attempt_ == report.attempt() && map_->step == report.step() && (map_->radio || !begins);
}

void Pilot::foresee(const wire::HeightProfile& message) {
  if (!profiles_.empty() && message.attempt() != profiles_attempt_) {
    if (older(message.attempt(), profiles_attempt_)) return;
    profiles_.clear();
  }
  const bool whole_route = type_.privilege == agents::Privilege::whole_route;
  if (known_ && (older(message.attempt(), attempt_) ||
                 (message.attempt() == attempt_ && (whole_route || message.step() <= expected_))))
    return;  // the report that needed it has been handled
  profiles_attempt_ = message.attempt();
  profiles_.insert_or_assign(message.step(), bus::profile(message));
}

bool Pilot::profiles_complete(const wire::ChannelReport& report) const {
  if (!agents::foresees(type_.privilege) || report.last()) return true;
  const bool whole_route = type_.privilege == agents::Privilege::whole_route;
  if (whole_route && report.step() > 0) return true;
  if (profiles_.empty() || profiles_attempt_ != report.attempt()) return false;
  return whole_route ? profiles_.size() == report.steps() : profiles_.contains(report.step() + 1);
}

bool Pilot::remember(const wire::StoredMemory& message) {
  if (!wanted_ || thinking_ || *wanted_ != EarlierFlight{message.condition(), message.trial()}) return false;
  recalled_ = wanted_;
  memory_ = wire::view(message.memory());
  return true;
}

bool Pilot::recall(const wire::ChannelReport& report) {
  wanted_.reset();
  const auto trial = spec_.remembered_trial(report.trial());
  if (!trial) {
    recalled_.reset();
    memory_.clear();
    return true;
  }
  const EarlierFlight earlier{report.condition(), *trial};
  if (recalled_ == earlier) return true;
  wanted_ = earlier;
  return false;
}

Pilot::Verdict Pilot::repeat(const wire::ChannelReport& report) const {
  if (report.step() + 1 != expected_) return Verdict::nothing;
  if (answered_) return Verdict::answer;
  return report.last() && !handed_over_.memory().empty() ? Verdict::hand_over : Verdict::nothing;
}

Pilot::Verdict Pilot::think(const wire::ChannelReport& report, bool begins) {
  episode_ = report.episode_id();
  attempt_ = report.attempt();
  expected_ = report.step() + 1;
  known_ = true;
  flying_ = !report.last();
  answered_ = false;
  thinking_ = true;
  address(report);
  task_.begins.reset();
  if (begins) {
    task_.begins = bus::flight_info(report);
    task_.memory = std::exchange(memory_, {});
    recalled_.reset();
    handed_over_.memory().clear();
  }
  task_.map.reset();
  if (map_ && map_attempt_ == attempt_ && map_->step == report.step() && !report.last()) {
    if (begins) route_in_parts_ = map_->known.route_points > 0;
    if (begins || route_in_parts_) task_.map = std::move(map_);
  }
  map_.reset();
  task_.profiles.clear();
  for (auto& [step, profile] : profiles_)
    if (profiles_attempt_ == attempt_ && agents::foresees(type_.privilege) && !report.last())
      task_.profiles.push_back(std::move(profile));
  profiles_.clear();
  task_.observation = bus::observation(report);
  task_.command.reset();
  task_.error.clear();
  return Verdict::think;
}

Pilot::Verdict Pilot::finish() {
  thinking_ = false;
  if (!task_.error.empty()) {
    known_ = flying_ = false;
    answer_.action(wire::ACTION_UNKNOWN_FLIGHT);
    return Verdict::answer;
  }
  if (!task_.command) {
    ++flights_;
    if (task_.memory.empty()) return Verdict::nothing;
    handed_over_.episode_id(episode_);
    handed_over_.attempt(attempt_);
    handed_over_.memory(wire::bytes(std::exchange(task_.memory, {})));
    return Verdict::hand_over;
  }
  bus::put(answer_, *task_.command);
  answered_ = true;
  return Verdict::answer;
}

Pilot::Verdict Pilot::unknown(const wire::ChannelReport& report) {
  if (report.last() && spec_.lineages() == 0) return Verdict::nothing;
  known_ = flying_ = answered_ = false;
  address(report);
  bus::put(answer_, agents::Command{});
  answer_.action(wire::ACTION_UNKNOWN_FLIGHT);
  return Verdict::answer;
}

void Pilot::keep(const wire::ChannelReport& report) {
  if (kept_.size() == max_kept) kept_.erase(kept_.begin());
  kept_.push_back(report);
}

void Pilot::address(const wire::ChannelReport& report) {
  answer_.episode_id(report.episode_id());
  answer_.attempt(report.attempt());
  answer_.step(report.step() + 1);
}

}  // namespace aloft::agent_host
