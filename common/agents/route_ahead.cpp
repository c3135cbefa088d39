#include "common/agents/route_ahead.hpp"

#include <algorithm>
#include <cmath>
#include <span>
#include <vector>

namespace aloft::agents {

std::optional<world::Position> RouteAhead::place(std::uint32_t step) const {
  if (step < first_step_ || step >= first_step_ + places_.size()) return std::nullopt;
  return places_[step - first_step_];
}

std::size_t RouteAhead::hear(const SiteMap& map) {
  const std::uint32_t first_told = map.step + 1;
  if (places_.empty() || first_told > first_step_ + places_.size()) {
    places_.clear();
    first_step_ = first_told;
  }
  if (first_told < first_step_) return 0;
  const std::size_t known = first_step_ + places_.size() - first_told;
  if (known >= map.route.size()) return 0;
  places_.insert(places_.end(), map.route.begin() + static_cast<std::ptrdiff_t>(known), map.route.end());
  return map.route.size() - known;
}

void RouteAhead::forget_before(std::uint32_t step) {
  for (; !places_.empty() && first_step_ < step; ++first_step_) places_.pop_front();
}

void RouteAhead::save(StateWriter& writer) const {
  writer.put_integer("route.first_step", first_step_);
  std::vector<double> metres;
  for (const world::Position& place : places_) metres.insert(metres.end(), {place.x_m, place.y_m});
  writer.put("route", std::span<const double>(metres));
}

void RouteAhead::restore(const StateReader& reader, std::uint32_t steps) {
  const std::uint64_t first_step = reader.integer("route.first_step");
  const auto metres = reader.doubles("route");
  if (metres.size() % 2 != 0 || first_step < 1 || first_step > std::uint64_t{steps} + 1 ||
      metres.size() / 2 > steps + 1 - first_step)
    reader.refuse("its route does not fit its flight");
  if (!std::ranges::all_of(metres, [](double metre) { return std::isfinite(metre); }))
    reader.refuse("its route has a number that is not finite");
  first_step_ = static_cast<std::uint32_t>(first_step);
  places_.clear();
  for (std::size_t i = 0; i < metres.size(); i += 2) places_.push_back({metres[i], metres[i + 1]});
}

}  // namespace aloft::agents
