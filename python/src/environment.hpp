#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "common/flight/flight.hpp"
#include "python/src/observer.hpp"
#include "python/src/worlds.hpp"

namespace aloft::python {

/// Which trial is flown.
struct Start {
  std::uint64_t seed = 0;
  std::uint32_t trial = 0;
  std::uint32_t condition = 0;
  bool operator==(const Start&) const = default;
};

/// Flies one UAV after the other.
class Environment {
 public:
  Environment(std::shared_ptr<const Worlds> worlds, const Layout& layout);

  /// Throws InputError; then nothing is flown.
  void begin(const Start& start);
  /// Executes an action; the caller has checked that the flight is not at its end.
  void step(agents::Action action);

  [[nodiscard]] bool begun() const noexcept { return flight_.has_value(); }
  /// Only what has begun may be asked for the rest.
  [[nodiscard]] const Start& start() const noexcept { return start_; }
  [[nodiscard]] const flight::Flight& flight() const noexcept { return *flight_; }
  [[nodiscard]] std::uint32_t heights() const noexcept { return map_->heights().size(); }
  [[nodiscard]] world::Position origin() const { return map_->start(); }
  [[nodiscard]] world::Position position() const;
  /// Where the result of each step will be read; if that depends on the flight, where it would be on a straight way.
  [[nodiscard]] std::vector<world::Position> route() const;
  /// Of the last step.
  [[nodiscard]] double energy_j() const;
  /// Whether the UAV was handed over in the last step.
  [[nodiscard]] bool handover() const noexcept { return flight_->handovers() > 0; }

  /// Quality at every height where the result of each step will be read, whatever is flown. InputError if the route
  /// depends on the flight.
  [[nodiscard]] std::vector<agents::HeightProfile> profiles() const;

  /// Writes Layout::size() values.
  void write_observation(std::span<float> to) const { observer_.write(to); }

  /// The flight so far as the result database stores it, flown by an agent of this name.
  [[nodiscard]] std::string trace(std::string_view agent) const;

 private:
  void note_report(bool first);

  std::shared_ptr<const Worlds> worlds_;
  Observer observer_;
  Start start_;
  flight::Costs costs_;
  std::unique_ptr<radio::SignalMap> map_;
  std::optional<flight::Flight> flight_;
};

}  // namespace aloft::python
