#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "common/agents/map_belief.hpp"
#include "common/agents/route_ahead.hpp"
#include "common/agents/route_plan.hpp"
#include "common/agents/site_survey.hpp"
#include "common/agents/steering.hpp"
#include "common/radio/expected_field.hpp"

namespace aloft::agents {

/// The parameters of SitePlanner.
[[nodiscard]] std::vector<ParameterSpec> site_planner_parameters();

/// Knows where the base stations are and the route ahead, and flies the best feasible flight through the spectral
/// efficiency that is to be expected there (radio::ExpectedField), by dynamic programming over the route that it knows.
/// It takes the mean over several maps that could be: where the map states an error, with positions drawn anew around
/// the stated ones; where it lacks stations, with others anywhere; where buildings often block the view, with buildings
/// drawn anew as densely and as high. For the next steps it weighs these maps by how well they explain the last
/// reports.
class SitePlanner : public SteeringAgent {
 public:
  /// `parameters`: at least site_planner_parameters().
  SitePlanner(std::string_view type, const Parameters& parameters);

  void begin(const FlightInfo& flight) override;
  void survey(const SiteMap& map) override;
  void observe(const Observation& observation) override;
  Command act() override;

 protected:
  /// The map of this flight; it must have been told.
  [[nodiscard]] const SiteSurvey& known() const { return *survey_; }
  [[nodiscard]] bool surveyed() const noexcept { return survey_.has_value(); }
  [[nodiscard]] RoutePlan& plan() noexcept { return plan_; }
  /// Of the steps after the latest report.
  [[nodiscard]] const RouteAhead& route() const noexcept { return route_; }
  /// Whether buildings are drawn; else line of sight is assumed everywhere.
  [[nodiscard]] bool blocked() const noexcept { return blocked_; }

  /// Expects something of the last `new_places` of route(), and plans from `step` on.
  virtual void look_ahead(std::uint32_t step, std::size_t new_places);

  void save(StateWriter& writer) const override;
  void restore(const StateReader& reader) override;

 private:
  [[nodiscard]] bool told_in_parts() const noexcept { return survey_->map.route_points > 0; }
  [[nodiscard]] int map_count() const noexcept;
  [[nodiscard]] bool may_weigh() const noexcept;
  [[nodiscard]] std::uint64_t map_seed(int i) const noexcept;
  [[nodiscard]] bool often_blocked(const std::vector<world::Position>& route) const;
  void add_missing(int i, std::vector<world::Site>& sites) const;
  [[nodiscard]] std::unique_ptr<radio::ExpectedField> make_field(int i) const;
  void expect_on_maps(std::size_t new_places, bool also_plan);
  [[nodiscard]] Action weighed_action() const;

  std::string type_;
  int maps_;
  double ignored_blocking_;
  std::optional<SiteSurvey> survey_;
  bool blocked_ = false;
  std::vector<std::unique_ptr<radio::ExpectedField>> fields_;  // as long as more of the route is to be told
  RouteAhead route_;
  RoutePlan plan_{1};
  std::optional<MapBelief> belief_;  // if there are several maps
};

}  // namespace aloft::agents
