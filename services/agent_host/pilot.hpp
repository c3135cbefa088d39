#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "common/agents/registry.hpp"
#include "common/bus/wire.hpp"

namespace aloft::agent_host {

/// Attempts are numbered in the order in which a channel starts flights; the numbers may wrap around.
[[nodiscard]] inline bool older(std::uint32_t a, std::uint32_t b) noexcept {
  return static_cast<std::int32_t>(a - b) < 0;
}

/// An agent's next computation. Self-contained, so that it can run in another thread.
struct Task {
  const agents::AgentSpec* spec = nullptr;
  std::unique_ptr<agents::Agent> agent;  ///< made by run() if a flight begins
  std::string memory;  ///< before a flight: that of an earlier one, or empty; after it: what the agent will remember
  std::optional<agents::FlightInfo> begins;  ///< set if a new flight begins
  std::optional<agents::SiteMap> map;
  std::vector<agents::HeightProfile> profiles;
  agents::Observation observation;
  std::optional<agents::Command> command;  ///< the result; none after the last report
  std::string error;                       ///< why the agent could not go on; empty if it could

  void run() noexcept;
};

/// Which report an agent may begin a flight with.
struct Boarding {
  std::uint32_t first_step = 0;
  bool late = false;  ///< any later report will do, too, also after missed ones
};

/// One agent on one stream: which flight, which step, what was answered. Handles every report exactly once, however
/// often it arrives. No bus, no clock; to be used from one thread.
class Pilot {
 public:
  /// `spec` must outlive the pilot.
  Pilot(const agents::AgentSpec& spec, std::uint32_t stream, Boarding boarding = {});

  enum class Verdict : std::uint8_t {
    nothing,    ///< a stale report, a repetition while its task runs, or a map, profile or memory is missing
    answer,     ///< send answer()
    think,      ///< run task(), then call finish()
    hand_over,  ///< send memory(): the flight is over, and the agent will need it later
  };
  /// An earlier flight of the pilot's agent.
  struct EarlierFlight {
    std::uint32_t condition = 0;
    std::uint32_t trial = 0;
    bool operator==(const EarlierFlight&) const = default;
  };

  /// Handles a report for this agent. While a task runs, and while a map, profile or memory is missing, reports are
  /// kept for resume().
  Verdict offer(const wire::ChannelReport& report);
  /// Handles the reports that were kept, one per call; `nothing` when no more can be handled now.
  Verdict resume();
  /// Takes a site map, which can arrive before or after the report that needs it; then call resume(). InputError if its
  /// radio is no world's.
  void survey(const wire::SiteMap& map);
  /// Takes a profile, which can arrive before or after the report that needs it; then call resume().
  void foresee(const wire::HeightProfile& profile);
  /// The flight whose memory the next flight needs to begin, if it is missing: to be requested whenever offer() or
  /// resume() returned `nothing`.
  [[nodiscard]] const std::optional<EarlierFlight>& wanted_memory() const noexcept { return wanted_; }
  /// True if this is the wanted memory; then call resume().
  bool remember(const wire::StoredMemory& message);

  [[nodiscard]] Task& task() noexcept { return task_; }
  /// To be called after the task has run. `answer`: send answer(); `nothing`, `hand_over`: the flight is over.
  Verdict finish();

  [[nodiscard]] wire::HeightCommand& answer() noexcept { return answer_; }
  [[nodiscard]] wire::FlightMemory& memory() noexcept { return handed_over_; }
  [[nodiscard]] bool thinking() const noexcept { return thinking_; }
  /// Whether the agent knows the flight of this report.
  [[nodiscard]] bool aboard(const wire::ChannelReport& report) const {
    return known_ && report.attempt() == attempt_ && report.episode_id() == episode_;
  }
  [[nodiscard]] bool flying() const noexcept { return flying_; }
  /// Flights seen to their end.
  [[nodiscard]] std::uint64_t flights() const noexcept { return flights_; }
  [[nodiscard]] const agents::AgentSpec& spec() const noexcept { return spec_; }

 private:
  [[nodiscard]] bool boards_at(std::uint32_t step) const noexcept;
  [[nodiscard]] bool map_there(const wire::ChannelReport& report, bool begins) const;
  [[nodiscard]] bool profiles_complete(const wire::ChannelReport& report) const;
  /// True if the memory that the flight needs is there, or it needs none; else sets wanted_memory().
  bool recall(const wire::ChannelReport& report);
  [[nodiscard]] Verdict repeat(const wire::ChannelReport& report) const;
  Verdict think(const wire::ChannelReport& report, bool begins);
  Verdict unknown(const wire::ChannelReport& report);
  void keep(const wire::ChannelReport& report);
  void address(const wire::ChannelReport& report);

  const agents::AgentSpec& spec_;
  const agents::AgentType& type_;
  Boarding boarding_;
  Task task_;
  wire::HeightCommand answer_;
  wire::FlightMemory handed_over_;         // of the latest flight, once it is over
  std::optional<EarlierFlight> wanted_;    // flight whose memory is missing
  std::optional<EarlierFlight> recalled_;  // flight that memory_ belongs to
  std::string memory_;
  std::vector<wire::ChannelReport> kept_;
  std::optional<agents::SiteMap> map_;  // the latest, of attempt map_attempt_
  std::uint32_t map_attempt_ = 0;
  bool route_in_parts_ = false;                              // of the flight that the agent knows
  std::map<std::uint32_t, agents::HeightProfile> profiles_;  // of attempt profiles_attempt_
  std::uint32_t profiles_attempt_ = 0;
  std::uint64_t episode_ = 0;
  std::uint32_t attempt_ = 0;
  std::uint32_t expected_ = 0;  // step of the next report
  std::uint64_t flights_ = 0;
  bool known_ = false;     // episode_ and attempt_ name a flight of which the agent knows every step
  bool flying_ = false;    // known_, and not over
  bool answered_ = false;  // answer_ belongs to step expected_
  bool thinking_ = false;
};

}  // namespace aloft::agent_host
