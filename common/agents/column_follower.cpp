#include <algorithm>
#include <cmath>
#include <cstdint>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include "common/agents/registry.hpp"
#include "common/agents/route_plan.hpp"
#include "common/agents/smoothed_levels.hpp"
#include "common/agents/steering.hpp"

namespace aloft::agents {
namespace {

enum class Column : std::uint8_t { present, next };

/// Knows the quality over all heights of one place, averaged over fading, and flies as if it stayed the same from there
/// on: the largest sum over the next `horizon` steps. References that show what such knowledge is worth, and no more:
/// `present-column` knows the place of the last report, `next-column` that of the next. On ties they prefer hold, then
/// down.
class ColumnFollower final : public SteeringAgent {
 public:
  ColumnFollower(const char* type, Column which, const Parameters& parameters)
      : SteeringAgent(type, parameters),
        which_(which),
        smoothing_m_(parameters.number("smoothing_m")),
        horizon_(static_cast<std::uint32_t>(parameters.integer("horizon"))) {}

  void begin(const FlightInfo& flight) override {
    SteeringAgent::begin(flight);
    column_.clear();
    next_.clear();
  }

  void foresee(const HeightProfile& profile) override {
    column_ = std::move(next_);
    next_ = smoothed_levels(profile, flight(), smoothing_m_);
    foreseen_step_ = profile.step;
  }

  Command act() override {
    if (foreseen_step_ != step() + 1) throw std::logic_error("a column follower was not shown the next step");
    const std::vector<double>& column = which_ == Column::next ? next_ : column_;
    return {column.empty() ? Action::hold : best_action(column)};
  }

 private:
  /// The first action of the best flight through a city where every place has this column.
  [[nodiscard]] Action best_action(const std::vector<double>& column) const {
    RoutePlan plan(column.size());
    for (std::uint32_t i = 0; i < std::min(horizon_, flight().steps - step()); ++i) plan.expect(column);
    plan.solve();
    return plan.action(plan.first_step(), level());
  }

  // The next column is shown before every command, but what is now the present one was shown earlier.
  void save(StateWriter& writer) const override { writer.put("column", next_); }

  void restore(const StateReader& reader) override {
    const auto column = reader.doubles("column");
    if (!column.empty() && column.size() != level_count(flight())) reader.refuse("its column does not fit its flight");
    if (!std::ranges::all_of(column, [](double value) { return std::isfinite(value); }))
      reader.refuse("its column has a value that is not finite");
    next_.assign(column.begin(), column.end());
  }

  Column which_;
  double smoothing_m_;
  std::uint32_t horizon_;
  std::uint32_t foreseen_step_ = 0;
  std::vector<double> column_;  // [level], of the last report; empty at the start, before which no place was shown
  std::vector<double> next_;
};

AgentType follower(const char* name, const char* description, Column which, Look look) {
  return {
      .name = name,
      .description = description,
      .privilege = Privilege::next_step,
      .looks = {std::move(look)},
      .parameters = {number_parameter("smoothing_m", 5.0, 0.0, 1000.0,
                                      "Takes the mean over heights up to this far away, against fading."),
                     integer_parameter("horizon", 100, 1, 10'000, "Steps for which it takes the column to stay.")},
      .make = [=](const Parameters& parameters) { return std::make_unique<ColumnFollower>(name, which, parameters); }};
}

const bool present_column_registered =
    register_agent(follower("present-column", "Knows the last report's place at every height: a reference.",
                            Column::present, {"present-column", 52, "#7b6b00", "#b7bf55", {8, 2, 2, 2, 2, 2}}));
const bool next_column_registered =
    register_agent(follower("next-column", "Knows the next report's place at every height: a reference.", Column::next,
                            {"next-column", 54, "#005250", "#68d3c8", {6, 2}}));

}  // namespace
}  // namespace aloft::agents
