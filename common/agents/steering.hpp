#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "common/agents/agent.hpp"
#include "common/agents/state_archive.hpp"
#include "common/base/parameters.hpp"

namespace aloft::agents {

/// Saves the facts of a flight, so that an agent can be restored in the middle of it.
void save_flight(StateWriter& writer, const FlightInfo& flight);
[[nodiscard]] FlightInfo restore_flight(const StateReader& reader);

/// The heights that single actions lead to: level 0 is Zmin, one level is d.
[[nodiscard]] std::uint32_t level_count(const FlightInfo& flight) noexcept;
/// The nearest level, also for heights between two of them (shadowing an unconstrained agent).
[[nodiscard]] std::uint32_t nearest_level(const FlightInfo& flight, double height_m) noexcept;

/// Base class of most agents: keeps the flight's limits and the present height, and saves and restores both.
class SteeringAgent : public Agent {
 public:
  SteeringAgent(std::string_view type, Parameters parameters);

  void begin(const FlightInfo& flight) override;
  void observe(const Observation& observation) override;
  [[nodiscard]] std::string save_state() const final;
  void restore_state(std::string_view bytes) final;

 protected:
  [[nodiscard]] const Parameters& parameters() const noexcept { return parameters_; }
  [[nodiscard]] const FlightInfo& flight() const noexcept { return flight_; }
  [[nodiscard]] double height_m() const noexcept { return height_m_; }
  [[nodiscard]] std::uint32_t level() const noexcept { return nearest_level(flight_, height_m_); }
  /// Steps flown so far.
  [[nodiscard]] std::uint32_t step() const noexcept { return step_; }

  /// Save and restore further memory. Before restore() is called, flight() has been restored.
  virtual void save(StateWriter& writer) const;
  virtual void restore(const StateReader& reader);

 private:
  std::string type_;
  Parameters parameters_;
  FlightInfo flight_;
  double height_m_ = 0.0;
  std::uint32_t step_ = 0;
};

}  // namespace aloft::agents
