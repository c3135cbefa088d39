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
  }

  void observe(const Observation& observation) override {
    const std::optional<world::Position> place = route().place(observation.step);
    SitePlanner::observe(observation);
    if (!belief_) return;
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

  void look_ahead(std::uint32_t step, std::size_t new_places) override {
    if (!learns()) return SitePlanner::look_ahead(step, new_places);
    if (!belief_) belief_ = make_belief();
  }

  void plan_ahead() {
    plan().forget_before(route().first_step());
    const auto earlier = plan().expected();
    std::vector<double> expected = mean_columns(std::min(horizon_, route().steps()));
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
        field.column(route().places()[w], column.data());
        for (std::size_t k = 0; k < levels; ++k) *sum++ += particle.weight * column[k];
      }
    }
    return mean;
  }

  void save(StateWriter& writer) const override {
    SitePlanner::save(writer);
    writer.put_integer("learns", belief_ ? 1 : 0);
    if (belief_) belief_->save(writer);
  }

  void restore(const StateReader& reader) override {
    SitePlanner::restore(reader);
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
     .looks = {{"site-filter", 76, "#683c00", "#ba8b48", {12, 4}}},
     .parameters = site_filter_parameters(),
     .make = [](const Parameters& parameters) { return std::make_unique<SiteFilter>(parameters); }});

}  // namespace
}  // namespace aloft::agents
