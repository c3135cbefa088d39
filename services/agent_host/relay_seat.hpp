#pragma once

#include <cstdint>

#include "common/agents/registry.hpp"
#include "common/bus/endpoint.hpp"
#include "services/agent_host/liveliness_timer.hpp"
#include "services/agent_host/pilot.hpp"

namespace aloft::agent_host {

/// What a crew member needs beyond a pilot: a writer of commands for its stream alone. DDS delivers what the strongest
/// live writer of a stream writes: the member that is asked makes its writer stronger than all before, the others
/// stand by, their strengths in the order of the crew.
class RelaySeat {
 public:
  /// `stands_by`: also answers reports that another member is asked to answer and does not; the middleware delivers
  /// these answers once the liveliness of the other's writer has expired.
  RelaySeat(const bus::Participant& participant, LivelinessTimer& liveliness, const agents::AgentSpec& relay,
            const agents::CrewMember& member, bool stands_by);
  ~RelaySeat();

  /// Which reports the member may begin a flight with.
  [[nodiscard]] Boarding boarding() const noexcept;
  /// Notes which member is asked, and takes or gives up the stream. False if the report does not concern this member.
  bool hear(const wire::ChannelReport& report, const Pilot& pilot);
  /// The member has been asked for the command that follows the latest report.
  [[nodiscard]] bool asked() const noexcept { return asked_; }
  /// The member should command: it is asked, or another member is and does not answer.
  [[nodiscard]] bool commands() const noexcept { return asked_ || (stands_by_ && repeated_); }
  void command(wire::HeightCommand& command) { writer_.write(command); }

 private:
  [[nodiscard]] std::uint32_t standby_strength() const noexcept;
  /// A writer owns only streams that it has written to. This command, which the channel ignores, makes the stream the
  /// member's before it has computed its first one: else commands of members that stand by would be delivered. It is
  /// repeated with the report, because readers can learn the strength of a writer later than what it wrote.
  void claim(const wire::ChannelReport& report);

  LivelinessTimer& liveliness_;
  const agents::CrewMember& member_;
  std::uint32_t place_;  // in the crew
  bool stands_by_;
  bool asked_ = false;
  bool repeated_ = false;
  bool heard_ = false;  // has received a report; the latest is attempt_, step_
  std::uint32_t attempt_ = 0;
  std::uint32_t step_ = 0;
  bus::Writer<wire::HeightCommand> writer_;
};

}  // namespace aloft::agent_host
