#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "common/agents/observation.hpp"
#include "common/agents/site_map.hpp"

namespace aloft::agents {

/// Internal values of a learner, for plots only.
struct Introspection {
  double epsilon = 0.0;
  double loss = 0.0;
  std::array<double, 3> q_values{};  ///< down, hold, up
};

/// The same, or nothing if a number is not finite, as when a network has diverged: such values are not stored or sent.
[[nodiscard]] std::optional<Introspection> showable(const std::optional<Introspection>& thoughts) noexcept;

struct Command {
  Action action = Action::hold;
  double height_m = 0.0;  ///< only with Action::absolute
  std::optional<Introspection> introspection{};
};

/// A height-control agent. One object flies one UAV at a time; calls alternate:
/// begin, [survey | foresee...], observe(step 0), act, [survey | foresee...], observe(step 1), act, ... observe(last).
/// An agent must be a pure function of these calls and its parameters: no clock, no global state.
class Agent {
 public:
  virtual ~Agent() = default;

  /// Starts a new flight. The agent keeps memory of earlier flights only if its parameters say so.
  virtual void begin(const FlightInfo& flight) = 0;

  /// For agents with privilege site_map only: the map, before the first report that the agent observes; and if the
  /// route is told in parts (SiteMap::known.route_points), the route ahead before every later report but the last.
  virtual void survey(const SiteMap& map);

  /// For agents that see the future only: future quality. Agents with privilege next_step get the profile of step j + 1
  /// before observe(j); those with whole_route get all profiles, in order, before observe(0).
  virtual void foresee(const HeightProfile& profile);

  /// Receives the report of a step. If this agent follows as a shadow, the executed action is another one's.
  virtual void observe(const Observation& observation) = 0;

  /// The command for the next step.
  virtual Command act() = 0;

  /// The agent's complete state: after restore_state, a new agent with the same parameters continues with the same
  /// commands, bit for bit. Called between act and observe or between flights.
  [[nodiscard]] virtual std::string save_state() const = 0;
  /// Throws IntegrityError if the bytes are not a state of this agent with these parameters.
  virtual void restore_state(std::string_view bytes) = 0;
};

}  // namespace aloft::agents
