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
// What the last reports tell of the maps is worth nothing far ahead; 20 steps were no better.
constexpr std::size_t weighed_steps = 10;
// Columns of longer flights, or of more maps, are not kept, so the maps are not weighed: 32 MB.
constexpr std::size_t most_kept = std::size_t{1} << 23U;

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
  route_ = {};
  plan_ = RoutePlan(level_count(flight));
  belief_.reset();
}

void SitePlanner::survey(const SiteMap& map) {
  if (!survey_) {
    survey_ = survey_from(map);
    blocked_ = often_blocked(map.route);
  }
  look_ahead(map.step + 1, route_.hear(map));
}

void SitePlanner::look_ahead(std::uint32_t step, std::size_t new_places) {
  plan_.forget_before(step);
  if (new_places > 0) expect_on_maps(new_places, true);
  plan_.solve();
}

void SitePlanner::observe(const Observation& observation) {
  SteeringAgent::observe(observation);
  if (belief_) {
    belief_->learn(observation.step, level(), observation.serving_sinr_db);
    belief_->forget_before(observation.step + 1);
  }
  route_.forget_before(observation.step + 1);
}

Command SitePlanner::act() {
  if (!plan_.covers(step() + 1)) throw std::logic_error(fmt::format("{} was not told the route ahead", type_));
  const bool weighs = belief_ && belief_->steps() > 0 && belief_->first_step() == step() + 1;
  return {weighs ? weighed_action() : plan_.action(step() + 1, level())};
}

/// The best flight over the next steps by the weighed maps, and after them by the mean over all.
Action SitePlanner::weighed_action() const {
  const std::uint32_t next = step() + 1;
  const std::size_t steps = std::min(weighed_steps, belief_->steps());
  RoutePlan ahead(plan_.levels());
  ahead.forget_before(next);
  ahead.expect(belief_->mean_columns(next, steps));
  if (const auto after = next + static_cast<std::uint32_t>(steps); plan_.covers(after))
    ahead.expect(plan_.values(after));
  ahead.solve();
  return ahead.action(next, level());
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

/// Whether there are several maps, and room for their columns.
bool SitePlanner::may_weigh() const noexcept {
  const auto maps = static_cast<std::size_t>(map_count());
  return maps > 1 && route_.steps() <= most_kept / maps / plan_.levels();
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

/// Computes the columns of the last `new_places` of the route on every map: the plan gets their mean, the belief all.
void SitePlanner::expect_on_maps(std::size_t new_places, bool also_plan) {
  const std::size_t levels = plan_.levels();
  const auto maps = static_cast<std::size_t>(map_count());
  const bool keep = may_weigh();
  const std::size_t known = route_.steps() - new_places;
  std::vector<double> mean(new_places * levels, 0.0);
  std::vector<double> column(levels);
  std::vector<std::vector<float>> of_maps(keep ? new_places : 0);
  for (std::size_t i = 0; i < maps; ++i) {
    std::unique_ptr<radio::ExpectedField> made;
    if (i >= fields_.size()) made = make_field(static_cast<int>(i));
    radio::ExpectedField& field = made ? *made : *fields_[i];
    for (std::size_t w = 0; w < new_places; ++w) {
      field.column(route_.places()[known + w], column.data());
      for (std::size_t k = 0; k < levels; ++k) mean[w * levels + k] += column[k];
      if (keep) of_maps[w].insert(of_maps[w].end(), column.begin(), column.end());
    }
    if (made && told_in_parts()) fields_.push_back(std::move(made));
  }
  for (double& value : mean) value /= static_cast<double>(maps);
  if (also_plan) plan_.expect(mean);
  if (!keep) return belief_.reset();
  if (!belief_) belief_.emplace(maps, levels);
  for (std::size_t w = 0; w < new_places; ++w)
    belief_->expect(route_.first_step() + static_cast<std::uint32_t>(known + w), std::move(of_maps[w]));
}

void SitePlanner::save(StateWriter& writer) const {
  save_survey(writer, survey_);
  writer.put_integer("blocked", blocked_ ? 1 : 0);
  route_.save(writer);
  plan_.save(writer);
  writer.put_integer("weighs", belief_ ? 1 : 0);
  if (belief_) belief_->save(writer);
}

void SitePlanner::restore(const StateReader& reader) {
  fields_.clear();
  survey_ = restore_survey(reader);
  blocked_ = reader.integer("blocked") != 0;
  plan_ = RoutePlan(level_count(flight()));
  plan_.restore(reader, flight().steps);
  route_.restore(reader, flight().steps);
  belief_.reset();
  const bool weighs = reader.integer("weighs") != 0;
  if (weighs && (!survey_ || !may_weigh())) reader.refuse("it weighs maps that it cannot have");
  if (weighs && route_.steps() > 0 &&
      (route_.first_step() != step() + 1 || !plan_.covers(step() + 1) ||
       plan_.first_step() + plan_.steps() != route_.first_step() + route_.steps()))
    reader.refuse("its route does not fit its plan");
  if (!survey_) return;
  try {
    if (weighs)
      expect_on_maps(route_.steps(), false);
    else if (told_in_parts())
      static_cast<void>(make_field(0));  // whether it fits
  } catch (const std::exception& error) {
    reader.refuse(error.what());
  }
  if (belief_) belief_->restore(reader);
}

namespace {

const bool site_planner_registered = register_agent(
    {.name = "site-planner",
     .description = "Knows the base stations and the route, and flies the best flight through what is to be expected.",
     .privilege = Privilege::site_map,
     .looks = {{"site-planner", 75, "#5335aa", "#b6b6ff", {14, 2, 4, 2}}},
     .parameters = site_planner_parameters(),
     .make = [](const Parameters& parameters) { return std::make_unique<SitePlanner>("site-planner", parameters); }});

}  // namespace
}  // namespace aloft::agents
