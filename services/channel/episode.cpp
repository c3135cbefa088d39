#include "services/channel/episode.hpp"

#include <algorithm>

#include "common/bus/convert.hpp"

namespace aloft::channel {
namespace {

// The first report may be sent before both sides have found each other; later ones are only lost with a process.
constexpr std::chrono::milliseconds first_patience{100};
constexpr std::chrono::milliseconds patience{1000};

}  // namespace

Episode::Episode(const EpisodeAddress& address, const agents::AgentSpec& agent, agents::Privilege privilege,
                 radio::SignalMap& map, std::uint64_t seed, const flight::Costs& costs, Clock::time_point now)
    : address_(address),
      agent_(agent),
      privilege_(privilege),
      unconstrained_(agents::agent_type(agent.type).unconstrained),
      remembers_(agent.lineages() > 0),
      flight_(map, seed, address.trial, costs),
      silent_since_(now),
      patience_(first_patience) {
  report_.stream(address_.stream);
  report_.experiment_id(wire::experiment_id(address_.experiment_id));
  report_.agent(wire::name(agent_.name));
  report_.executed_by(wire::name(""));
  report_.episode_id(address_.episode_id);
  report_.attempt(address_.attempt);
  report_.condition(address_.condition);
  bus::put(report_, flight_.info());
  report_.x_m(map.start().x_m);
  report_.y_m(map.start().y_m);
  profile_.stream(address_.stream);
  profile_.episode_id(address_.episode_id);
  profile_.attempt(address_.attempt);
  bus::put(report_, flight_.observation());
}

Episode::Outcome Episode::accept(const wire::HeightCommand& message, Clock::time_point now) {
  if (message.episode_id() != address_.episode_id || message.attempt() != address_.attempt ||
      message.step() != flight_.observation().step + 1 || message.agent() != agent_.name)
    return Outcome::ignored;
  if (flight_.finished() && !remembers_) return Outcome::ignored;
  if (message.action() == wire::ACTION_UNKNOWN_FLIGHT) return Outcome::lost;
  if (flight_.finished()) return Outcome::ignored;
  if (message.action() == wire::ACTION_ABSOLUTE && !unconstrained_) return Outcome::forbidden;
  flight_.step(bus::command(message), agent_.name);
  silent_since_ = now;
  patience_ = patience;
  describe();
  return flight_.finished() && !remembers_ ? Outcome::finished : Outcome::stepped;
}

Episode::Outcome Episode::accept(const wire::FlightMemory& message) {
  if (message.episode_id() != address_.episode_id || message.attempt() != address_.attempt ||
      message.agent() != agent_.name || !flight_.finished() || !remembers_)
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
  patience_ = std::min<Clock::duration>(2 * patience_, patience);
  flight::foresee(flight_, privilege_, profile_buffer_, [&](const agents::HeightProfile& profile) {
    bus::put(profile_, profile);
    send.profile(profile_);
  });
  send.report(report_);
}

}  // namespace aloft::channel
