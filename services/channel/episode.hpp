#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "common/agents/registry.hpp"
#include "common/bus/wire.hpp"
#include "common/flight/flight.hpp"

namespace aloft::channel {

using Clock = std::chrono::steady_clock;

/// What every report of a flight says about it.
struct EpisodeAddress {
  std::string experiment_id;
  std::uint64_t episode_id = 0;
  std::uint32_t attempt = 0;  ///< grows with every flight that this worker starts
  std::uint32_t stream = 0;
  std::uint32_t condition = 0;
  std::uint32_t trial = 0;
};

/// One flight in the air and its side of the lock-step conversation: the report that waits for its command. Each
/// command is executed once, however often it comes. No bus; the clock is passed in.
class Episode {
 public:
  enum class Outcome : std::uint8_t {
    ignored,    ///< stale, repeated, or of another flight
    stepped,    ///< executed: ask() for the next
    finished,   ///< executed, and it was the last: ask() tells the agent so, unless it was its memory that came
    lost,       ///< the agent has no history of this flight: start it again
    forbidden,  ///< the agent commanded what it may not
  };
  /// `agent` and `map` must outlive the episode.
  Episode(const EpisodeAddress& address, const agents::AgentSpec& agent, agents::Privilege privilege,
          radio::SignalMap& map, std::uint64_t seed, const flight::Costs& costs, Clock::time_point now);

  Outcome accept(const wire::HeightCommand& command, Clock::time_point now);
  /// What the agent remembers, after the last step; the flight of an agent that remembers earlier flights is finished
  /// only with it.
  Outcome accept(const wire::FlightMemory& message);

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
  [[nodiscard]] const EpisodeAddress& address() const noexcept { return address_; }
  [[nodiscard]] const flight::Flight& flight() const noexcept { return flight_; }
  /// Empty if the agent keeps none.
  [[nodiscard]] const std::vector<std::uint8_t>& agent_memory() const noexcept { return memory_; }

 private:
  void describe();

  EpisodeAddress address_;
  const agents::AgentSpec& agent_;
  agents::Privilege privilege_;
  bool unconstrained_;
  bool remembers_;  // earlier flights
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
