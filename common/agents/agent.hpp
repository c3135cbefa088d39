#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "common/agents/observation.hpp"

namespace aloft::agents {

/// What a learner thinks, for plots; never used to fly.
struct Introspection {
  double epsilon = 0.0;
  double loss = 0.0;
  std::array<double, 3> q_values{};  ///< down, hold, up
};

/// The same; nothing if a number is not finite, as with a network that has diverged: nobody stores or sends that.
[[nodiscard]] std::optional<Introspection> showable(const std::optional<Introspection>& thoughts) noexcept;

struct Command {
  Action action = Action::hold;
  double height_m = 0.0;  ///< only with Action::absolute
  std::optional<Introspection> introspection{};
};

/// A height-control agent. One object flies one UAV at a time; calls alternate:
/// begin, [foresee...], observe(step 0), act, [foresee...], observe(step 1), act, ... observe(last).
/// An agent must be a pure function of these calls and its parameters: no clock, no global state.
class Agent {
 public:
  virtual ~Agent() = default;

  /// A new flight starts. Memory of earlier flights may be kept only where the agent's parameters say so.
  virtual void begin(const FlightInfo& flight) = 0;

  /// Privileged agents only: the future they are allowed to see. Next-step agents get the profile of step j + 1 before
  /// observe(j); whole-route agents get all profiles, in order, before observe(0).
  virtual void foresee(const HeightProfile& profile);

  /// Learn from what happened. The executed action may have been commanded by someone else (shadow mode).
  virtual void observe(const Observation& observation) = 0;

  /// The command for the next step.
  virtual Command act() = 0;

  /// Everything that the future of this agent depends on, so that restore_state on a new agent with the same parameters
  /// continues with the same commands, bit for bit. Called between act and observe or between flights.
  [[nodiscard]] virtual std::string save_state() const = 0;
  /// Throws IntegrityError if the bytes are not a state of this agent with these parameters.
  virtual void restore_state(std::string_view bytes) = 0;
};

}  // namespace aloft::agents
