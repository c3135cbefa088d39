#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "common/agents/registry.hpp"
#include "common/bus/wire.hpp"
#include "common/flight/flight.hpp"
#include "services/channel/relay/crew.hpp"

namespace aloft::channel {

/// Identifies a flight; every report repeats it, except for the lease.
struct EpisodeAddress {
  std::uint64_t lease_id = 0;
  std::string experiment_id;
  std::uint64_t episode_id = 0;
  std::uint32_t attempt = 0;  ///< grows with every flight that this worker starts
  std::uint32_t stream = 0;
  std::uint32_t condition = 0;
  std::uint32_t trial = 0;
};

/// One flight in the air and the channel's side of the lock-step protocol: a report waits for its command. Each command
/// is executed once, however often it arrives; in a relay, after all members aboard have learnt from the report. No
/// bus; the clock is passed in.
class Episode {
 public:
  enum class Outcome : std::uint8_t {
    ignored,    ///< stale, repeated, or of another flight
    stepped,    ///< executed: ask() for the next
    finished,   ///< the last command was executed (ask() tells the agent so), or the memory after it arrived
    lost,       ///< the agent has no history of this flight: start it again
    forbidden,  ///< the command is not allowed for this agent
    passed_on,  ///< the agent cannot go on, and another one of its crew is chosen: ask()
  };
  /// `agent` and `map` must outlive the episode. `failover`: a relay goes on when one of its crew is lost.
  Episode(const EpisodeAddress& address, const agents::AgentSpec& agent, agents::Privilege privilege,
          radio::SignalMap& map, std::uint64_t seed, const flight::Costs& costs, Clock::time_point now,
          bool failover = false);

  /// For a relay that can go on without some of its crew, before the first ask(): these members are not there.
  void do_without(const std::vector<std::string>& absent, Clock::time_point now);
  /// An agent of this worker is there again.
  void comes(std::string_view agent);

  Outcome accept(const wire::HeightCommand& command, Clock::time_point now);
  /// The agent's memory after the last step; it finishes the flight of an agent that remembers earlier flights.
  Outcome accept(const wire::FlightMemory& message);
  /// A member of the crew has learnt from the present report.
  Outcome accept(const wire::ReportFollowed& message, Clock::time_point now);
  /// With failover, goes on without followers that have been silent for too long.
  Outcome wait_no_longer(Clock::time_point now);
  /// For a relay: from now on, or from a later step on, this agent of its crew flies. True if ask() is due.
  bool order(const SwapOrder& order, Clock::time_point now);
  /// True until a command of the ordered agent is executed.
  [[nodiscard]] bool order_open() const noexcept { return crew_ && crew_->order_open(); }

  struct Senders {
    std::function<void(wire::SiteMap&)> site_map;
    std::function<void(wire::HeightProfile&)> profile;
    std::function<void(wire::ChannelReport&)> report;
  };
  /// Sends what the agent needs for its next command.
  void ask(const Senders& send, Clock::time_point now);
  /// True if the question should be asked again.
  [[nodiscard]] bool repeat_due(Clock::time_point now) const noexcept { return now >= repeat_at_; }
  /// How long the agent has not answered.
  [[nodiscard]] Clock::duration silence(Clock::time_point now) const noexcept { return now - silent_since_; }

  [[nodiscard]] const agents::AgentSpec& agent() const noexcept { return agent_; }
  /// The agent that is asked: the flight's own, or one of its crew.
  [[nodiscard]] const agents::AgentSpec& pilot() const noexcept { return crew_ ? crew_->pilot() : agent_; }
  /// Names of the agents whose answer is missing.
  [[nodiscard]] std::string awaited() const;
  [[nodiscard]] const EpisodeAddress& address() const noexcept { return address_; }
  [[nodiscard]] const flight::Flight& flight() const noexcept { return flight_; }
  /// What the agent handed over at the end; empty if it keeps no memory.
  [[nodiscard]] const std::vector<std::uint8_t>& agent_memory() const noexcept { return memory_; }

 private:
  [[nodiscard]] bool concerns(std::uint64_t episode_id, std::uint32_t attempt) const noexcept {
    return episode_id == address_.episode_id && attempt == address_.attempt;
  }
  /// In a relay, makes the sender the pilot if it may command now; true if it may.
  [[nodiscard]] bool admit(const wire::HeightCommand& message, Clock::time_point now);
  Outcome execute(const wire::HeightCommand& message, Clock::time_point now);
  Outcome execute_held(Clock::time_point now);
  void describe();
  void address_pilot(Clock::duration patience);

  EpisodeAddress address_;
  const agents::AgentSpec& agent_;
  agents::Privilege privilege_;
  bool remembers_;                           // the agent remembers earlier flights
  std::unique_ptr<Crew> crew_;               // null if the agent is no relay
  std::optional<wire::HeightCommand> held_;  // a command, until all have followed
  flight::Flight flight_;
  std::vector<std::uint8_t> memory_;
  wire::ChannelReport report_;
  wire::SiteMap site_map_;
  bool whole_map_ =
      true;  // an update is not enough: it is the flight's first report, one sent again, or for another pilot
  wire::HeightProfile profile_;
  agents::HeightProfile profile_buffer_;
  Clock::time_point silent_since_;
  Clock::time_point repeat_at_;
  Clock::duration patience_;
};

}  // namespace aloft::channel
