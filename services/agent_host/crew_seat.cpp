#include "services/agent_host/crew_seat.hpp"

#include <algorithm>

#include "common/agents/relay.hpp"

namespace aloft::agent_host {
namespace {

constexpr std::uint32_t strengths_per_rank = 1000;

std::uint32_t place_of(const agents::AgentSpec& relay, const agents::CrewMember& member) {
  return static_cast<std::uint32_t>(&member - relay.crew.data());
}

}  // namespace

CrewSeat::CrewSeat(const bus::Participant& participant, LivelinessTimer& liveliness, const agents::AgentSpec& relay,
                   const agents::CrewMember& member, bool stands_by, std::uint32_t strength)
    : liveliness_(liveliness),
      member_(member),
      place_(place_of(relay, member)),
      stands_by_(stands_by),
      own_strength_(std::min(strength, strengths_per_rank - 1)),
      writer_(participant, {.strength = this->strength()}) {
  liveliness_.add(writer_);
}

CrewSeat::~CrewSeat() {
  liveliness_.remove(writer_);
}

Boarding CrewSeat::boarding() const noexcept {
  if (stands_by_) return {0, true};
  return {member_.boards_at().value_or(0), false};
}

std::uint32_t CrewSeat::strength() const noexcept {
  const auto rank = static_cast<std::uint32_t>(asked_ ? agents::max_crew : agents::max_crew - 1 - place_);
  return rank * strengths_per_rank + own_strength_;
}

void CrewSeat::claim(const wire::ChannelReport& report) {
  wire::HeightCommand claim;
  claim.stream(report.stream());
  claim.episode_id(report.episode_id());
  claim.attempt(report.attempt());
  claim.step(report.step() == 0 ? 2 : report.step());  // not the one that is asked for
  claim.agent(report.agent());
  claim.action(wire::ACTION_HOLD);
  writer_.write(claim);
}

bool CrewSeat::hear(const wire::ChannelReport& report, const Pilot& pilot) {
  if (heard_ && older(report.attempt(), attempt_)) return false;
  repeated_ = heard_ && report.attempt() == attempt_ && report.step() == step_;
  heard_ = true;
  attempt_ = report.attempt();
  step_ = report.step();
  const bool asked = report.agent() == member_.agent.name;
  if (asked != asked_) {
    asked_ = asked;
    writer_.set_strength(strength());
    if (asked_) claim(report);
  }
  return asked_ || member_.shadow || pilot.aboard(report);
}

}  // namespace aloft::agent_host
