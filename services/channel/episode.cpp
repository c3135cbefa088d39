#include "services/channel/episode.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "common/bus/convert.hpp"

namespace aloft::channel {
namespace {

// The first report may be sent before both sides have found each other; later ones are only lost with a process.
constexpr std::chrono::milliseconds first_patience{100};
constexpr std::chrono::milliseconds patience{1000};
// In a relay, members that stand by answer only repeated reports; and the first command of a new pilot can be lost
// because its writer is not known to be the strongest yet.
constexpr std::chrono::milliseconds relay_patience{100};
constexpr std::chrono::milliseconds relay_patience_limit{200};
constexpr std::chrono::milliseconds swap_patience{20};

}  // namespace

Episode::Episode(const EpisodeAddress& address, const agents::AgentSpec& agent, agents::Privilege privilege,
                 radio::SignalMap& map, std::uint64_t seed, const flight::Costs& costs, Clock::time_point now,
                 bool failover)
    : address_(address),
      agent_(agent),
      privilege_(privilege),
      remembers_(agent.lineages() > 0),
      crew_(agent.crew.empty() ? nullptr : std::make_unique<Crew>(agent, failover, now)),
      flight_(map, seed, address.trial, costs),
      silent_since_(now),
      patience_(first_patience) {
  report_.stream(address_.stream);
  report_.experiment_id(wire::experiment_id(address_.experiment_id));
  report_.agent(wire::name(pilot().name));
  if (crew_) report_.relay(wire::name(agent_.name));
  report_.executed_by(wire::name(""));
  report_.episode_id(address_.episode_id);
  report_.attempt(address_.attempt);
  report_.condition(address_.condition);
  bus::put(report_, flight_.info());
  report_.x_m(map.start().x_m);
  report_.y_m(map.start().y_m);
  site_map_.stream(address_.stream);
  site_map_.episode_id(address_.episode_id);
  site_map_.attempt(address_.attempt);
  profile_.stream(address_.stream);
  profile_.episode_id(address_.episode_id);
  profile_.attempt(address_.attempt);
  bus::put(report_, flight_.observation());
}

void Episode::do_without(const std::vector<std::string>& absent, Clock::time_point now) {
  if (crew_ && crew_->do_without(absent, now)) address_pilot(patience_);
}

void Episode::comes(std::string_view agent) {
  if (crew_) crew_->comes(agent);
}

bool Episode::admit(const wire::HeightCommand& message, Clock::time_point now) {
  if (!crew_) return message.agent() == agent_.name;
  if (held_ || !crew_->admit(wire::view(message.agent()), now)) return false;
  if (report_.agent() != message.agent()) address_pilot(patience_);
  return true;
}

Episode::Outcome Episode::accept(const wire::HeightCommand& message, Clock::time_point now) {
  if (!concerns(message.episode_id(), message.attempt()) || message.step() != flight_.observation().step + 1 ||
      !admit(message, now))
    return Outcome::ignored;
  if (flight_.finished() && !remembers_) return Outcome::ignored;
  if (message.action() == wire::ACTION_UNKNOWN_FLIGHT) {
    if (!crew_ || !crew_->pass_on(now)) return Outcome::lost;
    address_pilot(swap_patience);
    return Outcome::passed_on;
  }
  if (flight_.finished()) return Outcome::ignored;
  if (message.action() == wire::ACTION_ABSOLUTE && !agents::agent_type(pilot().type).unconstrained)
    return Outcome::forbidden;
  if (crew_ && !crew_->all_followed()) {
    held_ = message;
    return Outcome::ignored;
  }
  return execute(message, now);
}

Episode::Outcome Episode::execute(const wire::HeightCommand& message, Clock::time_point now) {
  flight_.step(bus::command(message), pilot().name);
  silent_since_ = now;
  patience_ = patience;
  whole_map_ = false;
  describe();
  if (crew_) {
    crew_->executed();
    if (!flight_.finished())
      address_pilot(crew_->begin_step(flight_.observation().step + 1, now) ? swap_patience : relay_patience);
  }
  return flight_.finished() && !remembers_ ? Outcome::finished : Outcome::stepped;
}

Episode::Outcome Episode::accept(const wire::ReportFollowed& message, Clock::time_point now) {
  if (!crew_ || !concerns(message.episode_id(), message.attempt()) || message.step() != flight_.observation().step ||
      flight_.finished())
    return Outcome::ignored;
  if (message.unknown_flight()) return crew_->failover() ? Outcome::ignored : Outcome::lost;
  crew_->followed(wire::view(message.agent()));
  return execute_held(now);
}

Episode::Outcome Episode::wait_no_longer(Clock::time_point now) {
  if (!held_) return Outcome::ignored;
  crew_->leave_behind(now);
  return execute_held(now);
}

Episode::Outcome Episode::execute_held(Clock::time_point now) {
  if (!held_ || !crew_->all_followed()) return Outcome::ignored;
  const wire::HeightCommand command = *held_;
  held_.reset();
  return execute(command, now);
}

bool Episode::order(const SwapOrder& order, Clock::time_point now) {
  if (!crew_ || flight_.finished() || !crew_->order(order, flight_.observation().step + 1, now)) return false;
  held_.reset();
  address_pilot(swap_patience);
  return true;
}

void Episode::address_pilot(Clock::duration patience) {
  whole_map_ = whole_map_ || report_.agent() != pilot().name;
  report_.agent(wire::name(pilot().name));
  patience_ = patience;
}

std::string Episode::awaited() const {
  if (!crew_ || !held_) return pilot().name;
  return fmt::format("{}", fmt::join(crew_->behind(), ", "));
}

Episode::Outcome Episode::accept(const wire::FlightMemory& message) {
  if (!concerns(message.episode_id(), message.attempt()) || message.agent() != agent_.name || !flight_.finished() ||
      !remembers_)
    return Outcome::ignored;
  memory_ = message.memory();
  return Outcome::finished;
}

void Episode::describe() {
  const flight::StepRecord& step = flight_.record().steps.back();
  report_.x_m(step.x_m);
  report_.y_m(step.y_m);
  report_.executed_by(report_.agent());
  bus::put(report_, flight_.observation());
}

void Episode::ask(const Senders& send, Clock::time_point now) {
  repeat_at_ = now + patience_;
  patience_ = std::min<Clock::duration>(2 * patience_, crew_ ? relay_patience_limit : patience);
  if (const auto map = flight::survey(flight_, privilege_, whole_map_)) {
    bus::put(site_map_, *map);
    send.site_map(site_map_);
  }
  whole_map_ = true;
  flight::foresee(flight_, privilege_, profile_buffer_, [&](const agents::HeightProfile& profile) {
    bus::put(profile_, profile);
    send.profile(profile_);
  });
  send.report(report_);
}

}  // namespace aloft::channel
