#pragma once

#include <cstdint>
#include <deque>
#include <optional>

#include "common/agents/site_map.hpp"
#include "common/agents/state_archive.hpp"

namespace aloft::agents {

/// Where the results of the next steps will be read, as an operator tells it, at once or in parts.
class RouteAhead {
 public:
  /// Places are known from this step on, for so many steps.
  [[nodiscard]] std::uint32_t first_step() const noexcept { return first_step_; }
  [[nodiscard]] std::size_t steps() const noexcept { return places_.size(); }
  [[nodiscard]] std::optional<world::Position> place(std::uint32_t step) const;
  /// From first_step() on.
  [[nodiscard]] const std::deque<world::Position>& places() const noexcept { return places_; }

  /// Adds what the map tells of steps after those that are known. Starts anew if it leaves out a step. Returns how
  /// many places are new.
  std::size_t hear(const SiteMap& map);
  void forget_before(std::uint32_t step);

  void save(StateWriter& writer) const;
  /// Of a flight with so many steps.
  void restore(const StateReader& reader, std::uint32_t steps);

 private:
  std::uint32_t first_step_ = 1;
  std::deque<world::Position> places_;
};

}  // namespace aloft::agents
