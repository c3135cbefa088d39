#include "common/flight/flight.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "common/base/error.hpp"

namespace aloft::flight {

using agents::Action;

double FlightRecord::qos_mean() const {
  double sum = 0.0;
  for (const StepRecord& step : steps) sum += step.qos;
  return sum / static_cast<double>(steps.size());
}

double FlightRecord::height_mean_m() const {
  double sum = 0.0;
  for (const StepRecord& step : steps) sum += step.height_m;
  return sum / static_cast<double>(steps.size());
}

std::uint32_t FlightRecord::height_changes() const {
  std::uint32_t changes = 0;
  double before_m = height_start_m;
  for (const StepRecord& step : steps) {
    if (step.height_m != before_m) ++changes;
    before_m = step.height_m;
  }
  return changes;
}

double FlightRecord::step_energy_j(std::size_t index, const Costs& costs) const {
  const double before_m = index == 0 ? height_start_m : steps.at(index - 1).height_m;
  return flight::step_energy_j(costs, steps.at(index).height_m - before_m);
}

double FlightRecord::energy_j(const Costs& costs) const {
  double sum = 0.0;
  for (std::size_t i = 0; i < steps.size(); ++i) sum += step_energy_j(i, costs);
  return sum;
}

std::optional<std::uint32_t> FlightRecord::handovers() const {
  std::optional<std::uint32_t> changes;
  std::int32_t before = -1;
  for (const StepRecord& step : steps) {
    if (step.serving_cell < 0) continue;
    changes = changes.value_or(0) + (before >= 0 && step.serving_cell != before ? 1 : 0);
    before = step.serving_cell;
  }
  return changes;
}

MobilityEvents FlightRecord::mobility() const {
  MobilityEvents sum;
  for (const StepRecord& step : steps) {
    sum.handovers += step.mobility.handovers;
    sum.ping_pongs += step.mobility.ping_pongs;
    sum.radio_link_failures += step.mobility.radio_link_failures;
    sum.outage_s += step.mobility.outage_s;
  }
  return sum;
}

double FlightRecord::outage_s(const Costs& costs) const {
  if (costs.a3) return mobility().outage_s;
  const auto out = std::ranges::count_if(
      steps, [&](const StepRecord& step) { return step.serving_sinr_db < costs.outage_threshold_db; });
  return static_cast<double>(out) * costs.step_s();
}

Flight::Flight(radio::SignalMap& map, std::uint64_t seed, std::uint32_t trial, const Costs& costs)
    : map_(map), costs_(costs), position_(map.start()) {
  const radio::HeightGrid& grid = map.heights();
  info_ = {map.qos_kind(), grid.height_min_m, grid.height_max_m, grid.height_step_m, map.steps(), seed, trial};
  record_.qos_kind = info_.qos;
  record_.height_start_m = grid.height_min_m;
  record_.steps.reserve(info_.steps);
  if (costs.a3) mobility_.emplace(*costs.a3, seed, trial, costs.step_s(), costs.outage_threshold_db);
  measure(0);
  observation_.last = info_.steps == 0;
}

world::Position Flight::result_position(std::uint32_t step) const noexcept {
  return map_.advance(map_.result_point(step), position_, observation_.serving_cell);
}

agents::HeightProfile Flight::profile(std::uint32_t step) const {
  agents::HeightProfile result;
  profile(step, result);
  return result;
}

void Flight::profile(std::uint32_t step, agents::HeightProfile& into) const {
  if (step < 1 || step > info_.steps || (!map_.fixed_route() && step != observation_.step + 1))
    throw std::logic_error(
        fmt::format("no profile of step {} is known at step {} of {}", step, observation_.step, info_.steps));
  const std::vector<radio::Reading>& column = map_.column(map_.result_point(step), result_position(step));
  into.step = step;
  into.height_min_m = info_.height_min_m;
  into.resolution_m = map_.heights().resolution_m;
  into.qos.resize(column.size());
  for (std::size_t i = 0; i < column.size(); ++i) into.qos[i] = column[i].qos;
}

agents::SiteMap Flight::site_map(bool update) const {
  const radio::Survey* survey = map_.survey();
  if (survey == nullptr)
    throw InputError(
        "an agent with the site map needs base stations that are known, and nothing is known of those of this measured "
        "flight; add a file sites.csv beside it, or leave this agent out");
  if (!map_.fixed_route())
    throw InputError(
        "an agent with the site map needs a route that is known beforehand, but the route rule 'serving' makes it "
        "depend on the flight; use the route rule 'nearest', or leave this agent out");
  agents::SiteMap map;
  map.step = observation_.step;
  map.known.position_error_m = survey->map.position_error_m;
  map.known.missing = survey->map.missing;
  map.known.route_points = survey->map.route_points;
  if (!update) {
    map.known.sites = survey->map.sites;
    map.radio = survey->radio;
  }
  const std::uint32_t told = survey->map.route_points;
  const std::uint32_t ahead = info_.steps - observation_.step;
  for (std::uint32_t i = 1; i <= (told == 0 ? ahead : std::min(told, ahead)); ++i)
    map.route.push_back(result_position(observation_.step + i));
  return map;
}

void Flight::step(const agents::Command& command, std::string_view pilot) {
  if (finished()) throw std::logic_error("a command after the last step of a flight");
  const std::uint32_t step = observation_.step + 1;
  const std::uint32_t point = map_.result_point(step);
  position_ = result_position(step);
  const double before_m = observation_.height_m;
  const Action executed = move(command);
  measure(point);
  observation_.step = step;
  observation_.executed = executed;
  handovers_ = count_handovers();
  observation_.reward = reward(observation_.height_m - before_m);
  observation_.last = step == info_.steps;
  record_.steps.push_back({step, executed, position_.x_m, position_.y_m, observation_.height_m,
                           observation_.serving_cell, observation_.serving_sinr_db, observation_.qos,
                           observation_.reward, pilot_index(pilot), agents::showable(command.introspection), events_});
}

Action Flight::move(const agents::Command& command) {
  const radio::HeightGrid& grid = map_.heights();
  const std::uint32_t top = grid.size() - 1;
  const std::uint32_t stride = grid.indices_per_step();
  const std::uint32_t before = level_;
  switch (command.action) {
    case Action::hold:
      return Action::hold;
    case Action::down:
      level_ -= std::min(level_, stride);
      return level_ == before ? Action::hold : Action::down;
    case Action::up:
      level_ = std::min(level_ + stride, top);
      return level_ == before ? Action::hold : Action::up;
    case Action::absolute: {
      const double index = std::floor((command.height_m - grid.height_min_m) / grid.resolution_m + 0.5);
      if (std::isnan(index)) throw std::logic_error("the height of a command is not a number");
      level_ = static_cast<std::uint32_t>(std::clamp(index, 0.0, static_cast<double>(top)));
      return Action::absolute;
    }
    case Action::none:
      break;
  }
  throw std::logic_error("a command without an action");
}

void Flight::measure(std::uint32_t point) {
  observation_.height_m = map_.heights().height_m(level_);
  mobility_ ? measure_served(point) : measure_strongest(point);
}

void Flight::measure_strongest(std::uint32_t point) {
  const radio::Reading reading = map_.reading(point, position_, level_);
  observation_.serving_cell = reading.serving_cell;
  observation_.serving_sinr_db = reading.serving_sinr_db;
  observation_.neighbour_count = reading.neighbour_count;
  observation_.neighbour_sinr_db = reading.neighbour_sinr_db;
  observation_.qos = reading.qos;
}

void Flight::measure_served(std::uint32_t point) {
  map_.scan(point, position_, level_, mobility_->followed(), scan_);
  const bool first = mobility_->serving() < 0;
  if (first) {
    mobility_->begin(scan_.cells);
  } else {
    const Mobility::Passage passage = mobility_->pass(scan_.cells);
    observation_.qos = passage.qos;
    events_ = passage.events;
  }
  const auto serving = std::ranges::find(scan_.cells, mobility_->serving(), &radio::CellReading::cell);
  observation_.serving_cell = serving->cell;
  observation_.serving_sinr_db = serving->sinr_db;
  if (first) observation_.qos = serving->qos;
  std::iter_swap(scan_.cells.begin(), serving);
  std::sort(scan_.cells.begin() + 1, scan_.cells.end(),
            [](const radio::CellReading& a, const radio::CellReading& b) { return a.sinr_db > b.sinr_db; });
  observation_.neighbour_count = std::min(scan_.neighbours, static_cast<std::uint32_t>(scan_.cells.size() - 1));
  observation_.neighbour_sinr_db = {};
  for (std::uint32_t i = 0; i < observation_.neighbour_count; ++i)
    observation_.neighbour_sinr_db.at(i) = scan_.cells[i + 1].sinr_db;
}

double Flight::reward(double climb_m) const {
  return observation_.qos * (handovers_ > 0 ? costs_.handover_loss : 1.0) -
         costs_.energy_weight * step_energy_j(costs_, climb_m) - handovers_ * costs_.handover_cost;
}

std::uint32_t Flight::count_handovers() {
  if (mobility_) return events_.handovers;
  const std::int32_t cell = observation_.serving_cell;
  const bool handover = cell >= 0 && scored_cell_ >= 0 && cell != scored_cell_;
  if (cell >= 0) scored_cell_ = cell;
  return handover ? 1 : 0;
}

std::uint32_t Flight::pilot_index(std::string_view pilot) {
  auto& pilots = record_.pilots;
  const auto at = std::ranges::find(pilots, pilot);
  const auto index = static_cast<std::uint32_t>(at - pilots.begin());
  if (at == pilots.end()) pilots.emplace_back(pilot);
  return index;
}

}  // namespace aloft::flight
