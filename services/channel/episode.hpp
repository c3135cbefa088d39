#pragma once

#include <chrono>
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

/// What every report of a flight says about it, but for the lease.
struct EpisodeAddress {
  std::uint64_t lease_id = 0;
  std::string experiment_id;
  std::uint64_t episode_id = 0;
  std::uint32_t attempt = 0;  ///< grows with every flight that this worker starts
  std::uint32_t stream = 0;
  std::uint32_t condition = 0;
  std::uint32_t trial = 0;
};

/// One flight in the air and its side of the lock-step conversation: the report that waits for its command. Each
/// command is executed once, however often it comes; in a relay, after all who are aboard have learnt from the report.
/// No bus; the clock is passed in.
class Episode {
 public:
  enum class Outcome : std::uint8_t {
    ignored,    ///< stale, repeated, or of another flight
    stepped,    ///< executed: ask() for the next
    finished,   ///< executed, and it was the last: ask() tells the agent so, unless it was its memory that came
    lost,       ///< the agent has no history of this flight: start it again
    forbidden,  ///< the agent commanded what it may not
    passed_on,  ///< the agent cannot go on, another of its crew is asked: ask()
  };
  /// `agent` and `map` must outlive the episode. `failover`: a relay goes on when one of its crew is lost.
  Episode(const EpisodeAddress& address, const agents::AgentSpec& agent, agents::Privilege privilege,
          radio::SignalMap& map, std::uint64_t seed, const flight::Costs& costs, Clock::time_point now,
          bool failover = false);

  /// Before the first ask(), for a relay that may go on without some of its crew: these are not there.
  void do_without(const std::vector<std::string>& absent, Clock::time_point now);
  /// An agent of this worker is there again.
  void comes(std::string_view agent);

  Outcome accept(const wire::HeightCommand& command, Clock::time_point now);
  /// What the agent remembers, after the last step; the flight of an agent that remembers earlier flights is finished
  /// only with it.
  Outcome accept(const wire::FlightMemory& message);
  /// One of the crew has learnt from the present report.
  Outcome accept(const wire::ReportFollowed& message, Clock::time_point now);
  /// Goes on without followers that are silent for too long, if the flight may.
  Outcome wait_no_longer(Clock::time_point now);
  /// For a relay: from now on, or from a later step on, this agent of its crew flies. True: ask().
  bool order(const SwapOrder& order, Clock::time_point now);
  /// Whether the ordered agent has not commanded yet.
  [[nodiscard]] bool order_open() const noexcept { return crew_ && crew_->order_open(); }

  struct Senders {
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
  /// Who is asked: the agent, or one of its crew.
  [[nodiscard]] const agents::AgentSpec& pilot() const noexcept { return crew_ ? crew_->pilot() : agent_; }
  /// Whose answer is missing, in words.
  [[nodiscard]] std::string awaited() const;
  [[nodiscard]] const EpisodeAddress& address() const noexcept { return address_; }
  [[nodiscard]] const flight::Flight& flight() const noexcept { return flight_; }
  /// Empty if the agent keeps none.
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
  bool remembers_;                           // earlier flights
  std::unique_ptr<Crew> crew_;               // of a relay, else null
  std::optional<wire::HeightCommand> held_;  // until all have followed
  flight::Flight flight_;
  std::vector<std::uint8_t> memory_;
  wire::ChannelReport report_;
  wire::HeightProfile profile_;
  agents::HeightProfile profile_buffer_;
  Clock::time_point silent_since_;
  Clock::time_point repeat_at_;
  Clock::duration patience_;
};

}  // namespace aloft::channel
