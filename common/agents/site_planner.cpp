#include "common/agents/site_planner.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>
#include <utility>

#include "common/agents/registry.hpp"
#include "common/base/limits.hpp"
#include "common/base/random.hpp"

namespace aloft::agents {
namespace {

constexpr std::size_t places_looked_at = 16;  // of the route

}  // namespace

std::vector<ParameterSpec> site_planner_parameters() {
  return {
      integer_parameter("maps", 64, 1, 1024,
                        "Maps drawn anew to take the mean of, if the site map states an error or gaps, or buildings "
                        "block more than ignored_blocking."),
      number_parameter("ignored_blocking", 0.1, 0.0, 1.0,
                       "Share of links that buildings block at the lowest height up to which line of sight is "
                       "assumed everywhere.")};
}

SitePlanner::SitePlanner(std::string_view type, const Parameters& parameters)
    : SteeringAgent(type, parameters),
      type_(type),
      maps_(parameters.integer("maps")),
      ignored_blocking_(parameters.number("ignored_blocking")) {}

void SitePlanner::begin(const FlightInfo& flight) {
  SteeringAgent::begin(flight);
  survey_.reset();
  blocked_ = false;
  fields_.clear();
  plan_ = RoutePlan(level_count(flight));
}

void SitePlanner::survey(const SiteMap& map) {
  if (!survey_) {
    survey_ = survey_from(map);
    blocked_ = often_blocked(map.route);
  }
  look_ahead(map);
}

void SitePlanner::look_ahead(const SiteMap& map) {
  plan_.forget_before(map.step + 1);
  plan_.expect(mean_columns(std::span(map.route).subspan(std::min(plan_.steps(), map.route.size()))));
  plan_.solve();
}

Command SitePlanner::act() {
  if (!plan_.covers(step() + 1)) throw std::logic_error(fmt::format("{} was not told the route ahead", type_));
  return {plan_.action(step() + 1, level())};
}

/// How many maps there are to take the mean of.
int SitePlanner::map_count() const noexcept {
  const bool exact = survey_->map.position_error_m == 0.0 && survey_->map.missing == 0.0;
  return blocked_ || !exact ? maps_ : 1;
}

/// The seed of the i-th map: never that of the flight, whose trial has the true one.
std::uint64_t SitePlanner::map_seed(int i) const noexcept {
  return flight().seed + mix64(static_cast<std::uint64_t>(i) + 1);
}

/// Whether buildings block more of the links from the lowest height than may be ignored.
bool SitePlanner::often_blocked(const std::vector<world::Position>& route) const {
  const std::size_t stride = std::max<std::size_t>(1, route.size() / places_looked_at);
  std::vector<world::Position> places;
  for (std::size_t i = 0; i < route.size(); i += stride) places.push_back(route[i]);
  const radio::ExpectedField field(survey_->radio, survey_->map.sites, map_seed(0), flight().trial);
  return field.blocked_share(places) > ignored_blocking_;
}

/// Adds stations where they could be, as many as the map lacks on average.
void SitePlanner::add_missing(int i, std::vector<world::Site>& sites) const {
  const double missing = survey_->map.missing;
  if (missing == 0.0) return;
  RandomStream stream(map_seed(i), flight().trial, "imagined sites");
  const double half_m = 0.5 * survey_->radio.number("window_m");
  const std::uint32_t count = stream.poisson(static_cast<double>(sites.size()) * missing / (1.0 - missing));
  for (std::uint32_t k = 0; k < count && sites.size() < limits::base_stations; ++k) {
    const double x_m = stream.uniform(-half_m, half_m);
    const double y_m = stream.uniform(-half_m, half_m);
    sites.push_back({-1, {x_m, y_m}, stream.uniform(-180.0, 180.0)});
  }
}

std::unique_ptr<radio::ExpectedField> SitePlanner::make_field(int i) const {
  const SiteSurvey& survey = *survey_;
  std::vector<world::Site> sites = survey.map.sites;
  RandomStream errors(map_seed(i), flight().trial, "redrawn sites");
  if (survey.map.position_error_m > 0.0) {
    for (world::Site& site : sites) {
      site.position.x_m += survey.map.position_error_m * errors.normal();
      site.position.y_m += survey.map.position_error_m * errors.normal();
    }
  }
  add_missing(i, sites);
  auto field = blocked_ ? std::make_unique<radio::ExpectedField>(survey.radio, sites, map_seed(i), flight().trial)
                        : std::make_unique<radio::ExpectedField>(survey.radio, sites);
  if (field->levels() != plan_.levels()) throw std::logic_error("the site map is of other heights");
  return field;
}

/// The expected columns at these points of the route, [point][level]: the mean over the maps.
std::vector<double> SitePlanner::mean_columns(std::span<const world::Position> points) {
  const std::size_t levels = plan_.levels();
  std::vector<double> mean(points.size() * levels, 0.0);
  std::vector<double> column(levels);
  for (int i = 0; i < map_count() && !points.empty(); ++i) {
    std::unique_ptr<radio::ExpectedField> made;
    if (static_cast<std::size_t>(i) >= fields_.size()) made = make_field(i);
    radio::ExpectedField& field = made ? *made : *fields_[static_cast<std::size_t>(i)];
    double* sum = mean.data();
    for (const world::Position& point : points) {
      field.column(point, column.data());
      for (std::size_t k = 0; k < levels; ++k) *sum++ += column[k];
    }
    if (made && told_in_parts()) fields_.push_back(std::move(made));
  }
  for (double& value : mean) value /= map_count();
  return mean;
}

void SitePlanner::save(StateWriter& writer) const {
  save_survey(writer, survey_);
  writer.put_integer("blocked", blocked_ ? 1 : 0);
  plan_.save(writer);
}

void SitePlanner::restore(const StateReader& reader) {
  fields_.clear();
  survey_ = restore_survey(reader);
  blocked_ = reader.integer("blocked") != 0;
  plan_ = RoutePlan(level_count(flight()));
  plan_.restore(reader, flight().steps);
  if (!survey_ || !told_in_parts()) return;
  try {
    static_cast<void>(make_field(0));  // whether it fits
  } catch (const std::exception& error) {
    reader.refuse(error.what());
  }
}

namespace {

const bool site_planner_registered = register_agent(
    {.name = "site-planner",
     .description = "Knows the base stations and the route, and flies the best flight through what is to be expected.",
     .privilege = Privilege::site_map,
     .looks = {{"site-planner", 75, "#5d4db8", "#a99bf0", {1, 0}}},
     .parameters = site_planner_parameters(),
     .make = [](const Parameters& parameters) { return std::make_unique<SitePlanner>("site-planner", parameters); }});

}  // namespace
}  // namespace aloft::agents
