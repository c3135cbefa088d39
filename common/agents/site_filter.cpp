#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>
#include <span>
#include <stdexcept>
#include <utility>
#include <vector>

#include "common/agents/registry.hpp"
#include "common/agents/site_belief.hpp"
#include "common/agents/site_planner.hpp"
#include "common/radio/approximations.hpp"

namespace aloft::agents {
namespace {

using Report = radio::ReportLikelihood::Report;

/// Like site-planner, but where the map states an error, it learns from the reports where the base stations are
/// (SiteBelief), and plans a few steps ahead through the mean of what is to be expected on the maps that could be.
class SiteFilter final : public SitePlanner {
 public:
  explicit SiteFilter(const Parameters& parameters)
      : SitePlanner("site-filter", parameters),
        horizon_(static_cast<std::size_t>(parameters.integer("horizon"))),
        memory_(parameters.number("memory")),
        settings_{static_cast<std::uint32_t>(parameters.integer("particles")),
                  static_cast<std::uint32_t>(parameters.integer("reports")),
                  static_cast<std::uint32_t>(parameters.integer("moves"))} {}

  void begin(const FlightInfo& flight) override {
    SitePlanner::begin(flight);
    belief_.reset();
    route_.clear();
    first_step_ = 1;
  }

  void observe(const Observation& observation) override {
    SitePlanner::observe(observation);
    if (!belief_) return;
    const std::optional<world::Position> place = take_place(observation.step);
    const auto& sites = known().map.sites;
    const auto serving = std::ranges::find(sites, observation.serving_cell, &world::Site::cell);
    if (place && serving != sites.end())
      belief_->learn(report_of(observation, *place, static_cast<std::uint32_t>(serving - sites.begin())));
  }

  Command act() override {
    if (belief_) plan_ahead();
    return SitePlanner::act();
  }

 private:
  static Report report_of(const Observation& observation, world::Position place, std::uint32_t serving) {
    Report report{place, observation.height_m, serving, 1, {}};
    report.sinr[0] = radio::power_of_ten(observation.serving_sinr_db / 10.0);
    for (std::uint32_t i = 0; i < observation.neighbour_count; ++i)
      report.sinr[report.sinrs++] = radio::power_of_ten(observation.neighbour_sinr_db[i] / 10.0);
    return report;
  }

  [[nodiscard]] bool learns() const {
    const world::SiteMap& map = known().map;
    return !blocked() && map.position_error_m > 0.0 && !map.sites.empty() && map.sites.size() <= most_sites;
  }

  [[nodiscard]] std::unique_ptr<SiteBelief> make_belief() const {
    return std::make_unique<SiteBelief>(known(), settings_, RandomStream(flight().seed, flight().trial, "site filter"));
  }

  void look_ahead(const SiteMap& map) override {
    if (!learns()) return SitePlanner::look_ahead(map);
    if (!belief_) belief_ = make_belief();
    if (map.step + 1 > first_step_ + route_.size()) {  // nothing is known of the steps before
      route_.clear();
      first_step_ = map.step + 1;
    }
    const std::size_t told = first_step_ + route_.size() - (map.step + 1);
    for (std::size_t i = told; i < map.route.size(); ++i) route_.push_back(map.route[i]);
  }

  /// The place of a report, if the route has it; the route then begins after it.
  std::optional<world::Position> take_place(std::uint32_t step) {
    if (step < first_step_ || step >= first_step_ + route_.size()) return std::nullopt;
    const std::size_t past = step - first_step_;
    const world::Position place = route_[past];
    route_.erase(route_.begin(), route_.begin() + static_cast<std::ptrdiff_t>(past) + 1);
    first_step_ = step + 1;
    return place;
  }

  void plan_ahead() {
    plan().forget_before(first_step_);
    const auto earlier = plan().expected();
    std::vector<double> expected = mean_columns(std::min(horizon_, route_.size()));
    for (std::size_t i = 0; i < std::min(earlier.size(), expected.size()); ++i)
      expected[i] = memory_ * earlier[i] + (1.0 - memory_) * expected[i];
    plan().expect_instead(std::move(expected));
    plan().solve();
  }

  /// Of the next points of the route: the mean over the maps that could be, by weight.
  [[nodiscard]] std::vector<double> mean_columns(std::size_t points) {
    const std::size_t levels = plan().levels();
    std::vector<double> mean(points * levels, 0.0);
    std::vector<double> column(levels);
    std::vector<world::Site> sites = known().map.sites;
    for (const SiteBelief::Particle& particle : belief_->particles()) {
      for (std::size_t k = 0; k < sites.size(); ++k) sites[k].position = particle.stations[k];
      radio::ExpectedField field(known().radio, sites);
      if (field.levels() != levels) throw std::logic_error("the site map is of other heights");
      double* sum = mean.data();
      for (std::size_t w = 0; w < points; ++w) {
        field.column(route_[w], column.data());
        for (std::size_t k = 0; k < levels; ++k) *sum++ += particle.weight * column[k];
      }
    }
    return mean;
  }

  void save(StateWriter& writer) const override {
    SitePlanner::save(writer);
    writer.put_integer("next_step", first_step_);
    std::vector<double> route;
    for (const world::Position& point : route_) route.insert(route.end(), {point.x_m, point.y_m});
    writer.put("route", std::span<const double>(route));
    writer.put_integer("learns", belief_ ? 1 : 0);
    if (belief_) belief_->save(writer);
  }

  void restore(const StateReader& reader) override {
    SitePlanner::restore(reader);
    first_step_ = static_cast<std::uint32_t>(reader.integer("next_step"));
    const auto route = reader.doubles("route");
    if (route.size() % 2 != 0) reader.refuse("its route is cut");
    if (!std::ranges::all_of(route, [](double metres) { return std::isfinite(metres); }))
      reader.refuse("its route has a number that is not finite");
    route_.clear();
    for (std::size_t i = 0; i < route.size(); i += 2) route_.push_back({route[i], route[i + 1]});
    belief_.reset();
    if (reader.integer("learns") == 0) return;
    if (!surveyed() || !learns()) reader.refuse("it learns a map that it does not have");
    belief_ = make_belief();
    belief_->restore(reader);
  }

  /// Of larger maps it does not learn, but plans as site-planner does: its memory grows with their size.
  static constexpr std::size_t most_sites = 1000;

  std::size_t horizon_;
  double memory_;
  SiteBelief::Settings settings_;
  std::unique_ptr<SiteBelief> belief_;  // if it learns
  std::uint32_t first_step_ = 1;
  std::vector<world::Position> route_;  // of first_step_ and later
};

std::vector<ParameterSpec> site_filter_parameters() {
  std::vector<ParameterSpec> table = site_planner_parameters();
  table.push_back(integer_parameter("particles", 8, 1, 1024, "Maps that could be, while it learns."));
  table.push_back(integer_parameter("reports", 30, 1, 1000, "Last reports that moves of sites must fit."));
  table.push_back(
      integer_parameter("moves", 60, 0, 10'000,
                        "Moves of a site that are tried per map after each report; more while there are few reports."));
  table.push_back(integer_parameter("horizon", 20, 1, 1000, "Steps that it plans ahead while it learns."));
  table.push_back(number_parameter("memory", 0.7, 0.0, 0.99,
                                   "Weight of the expectation of a step before a report against that after it."));
  return table;
}

const bool site_filter_registered = register_agent(
    {.name = "site-filter",
     .description = "Like site-planner, and learns from the reports where the base stations of a wrong map are.",
     .privilege = Privilege::site_map,
     .learns = true,
     .host = Host::baseline_agent,  // whose role alone reads the site map in secured runs
     .looks = {{"site-filter", 76, "#7d4a24", "#c8935f", {5, 2}}},
     .parameters = site_filter_parameters(),
     .make = [](const Parameters& parameters) { return std::make_unique<SiteFilter>(parameters); }});

}  // namespace
}  // namespace aloft::agents
