#include "services/agent_host/relay_seat.hpp"

#include "common/agents/relay.hpp"

namespace aloft::agent_host {
namespace {

// Readers notice late that a writer lowers its strength, so the member that is asked has to be stronger than every
// member before it: its strength grows with the attempt and the step (at most 10,000) of its report.
constexpr unsigned step_bits = 14;
constexpr std::uint32_t attempts_told_apart = 1U << 17U;

std::uint32_t place_of(const agents::AgentSpec& relay, const agents::CrewMember& member) {
  return static_cast<std::uint32_t>(&member - relay.crew.data());
}

}  // namespace

RelaySeat::RelaySeat(const bus::Participant& participant, LivelinessTimer& liveliness, const agents::AgentSpec& relay,
                     const agents::CrewMember& member, bool stands_by)
    : liveliness_(liveliness),
      member_(member),
      place_(place_of(relay, member)),
      stands_by_(stands_by),
      writer_(participant, {.strength = standby_strength()}) {
  liveliness_.add(writer_);
}

RelaySeat::~RelaySeat() {
  liveliness_.remove(writer_);
}

Boarding RelaySeat::boarding() const noexcept {
  if (stands_by_) return {0, true};
  return {member_.boards_at().value_or(0), false};
}

std::uint32_t RelaySeat::standby_strength() const noexcept {
  return static_cast<std::uint32_t>(agents::max_crew) - place_;
}

void RelaySeat::claim(const wire::ChannelReport& report) {
  wire::HeightCommand claim;
  claim.stream(report.stream());
  claim.episode_id(report.episode_id());
  claim.attempt(report.attempt());
  claim.step(report.step() == 0 ? 2 : report.step());  // not the step that is asked for: the channel ignores it
  claim.agent(report.agent());
  claim.action(wire::ACTION_HOLD);
  writer_.write(claim);
}

bool RelaySeat::hear(const wire::ChannelReport& report, const Pilot& pilot) {
  if (heard_ && older(report.attempt(), attempt_)) return false;
  repeated_ = heard_ && report.attempt() == attempt_ && report.step() == step_;
  heard_ = true;
  attempt_ = report.attempt();
  step_ = report.step();
  const bool asked = report.agent() == member_.agent.name;
  const bool asked_anew = asked && !asked_;
  if (asked != asked_) {
    asked_ = asked;
    const std::uint32_t turn = ((attempt_ % attempts_told_apart + 1) << step_bits) + step_;
    writer_.set_strength(asked_ ? turn : standby_strength());
  }
  if (asked_ && (asked_anew || repeated_)) claim(report);
  return asked_ || member_.shadow || pilot.aboard(report);
}

}  // namespace aloft::agent_host
