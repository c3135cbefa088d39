#include "tools/report/tournament_table.hpp"

#include <catch2/catch.hpp>

#include "tools/report/test_trials.hpp"

using namespace aloft::report;
using aloft::report::testing::agent;
using aloft::report::testing::condition;
using Catch::Contains;

namespace {

/// Gains at 1 / 200: planner 4, learner 1; at 5 / 200: planner 6, learner 3, the other learner -1.
std::vector<ConditionTrials> two_conditions() {
  return {condition(1, 200,
                    {agent("min-height", "min-height", {4.0, 6.0}), agent("planner", "planner", {8.0, 10.0}),
                     agent("pretrained", "pretrained", {5.0, 7.0})}),
          condition(5, 200,
                    {agent("min-height", "min-height", {1.0, 2.0}), agent("planner", "planner", {7.0, 8.0}),
                     agent("pretrained", "pretrained", {4.0, 5.0}), agent("dqn", "dqn", {0.0, 1.0})})};
}

}  // namespace

namespace {

std::string overview(const std::vector<ConditionTrials>& conditions, const StepCosts& costs) {
  return tournament_overview(conditions, costs).markdown();
}

}  // namespace

TEST_CASE("In a terminal the overview goes on below where it does not fit, and is brief if asked", "[report]") {
  const aloft::TextTable table = tournament_overview(two_conditions(), {{"pretrained", 7.04}});
  CHECK_THAT(table.text({.width = 60}), Contains("  agent       1 / 200  5 / 200  head-room closed") &&
                                            Contains("  agent       height changes    kJ  µs per step") &&
                                            !Contains("*+") && !Contains("|"));
  CHECK_THAT(table.text({}, 0), Contains("5 / 200\n") && !Contains("kJ"));
  CHECK_THAT(table.text({.bold = true}), Contains("\033[1m+1.00\033[0m"));
}

TEST_CASE("The overview has a line per agent; head-room is shared over the conditions", "[report]") {
  const std::string text = overview(two_conditions(), {{"pretrained", 7.04}});
  CHECK_THAT(text, Contains("| agent | 1 / 200 | 5 / 200 | head-room closed | height changes | kJ | µs per step |"));
  // 1 of 4 and 3 of 6: 38 % in the mean
  CHECK_THAT(text, Contains("| pretrained | **+1.00** | **+3.00** | 38 % | 0 | 12.5 | 7.0 |"));
  CHECK_THAT(text, Contains("| planner ** | +4.00 | +6.00 | 100 % |"));  // privileged: never bold
  CHECK_THAT(text, Contains("| dqn | - | -1.00 | - | - | - | - |"));     // did not fly everywhere
}

TEST_CASE("An agent that flew over the same worlds in another run stands in the same columns", "[report]") {
  std::vector<ConditionTrials> conditions = two_conditions();
  conditions[0].agents.pop_back();
  conditions.push_back(condition(1, 200, {agent("min-height", "min-height", {4.0}), agent("dqn", "dqn", {3.5})}));
  CHECK_THAT(overview(conditions, {}),
             Contains("| agent | 1 / 200 | 5 / 200 | head") && Contains("| dqn | -0.50 | -1.00 | - |"));
  conditions.back().seed = 7;
  CHECK_THAT(overview(conditions, {}), Contains("| agent | 1 / 200 | 5 / 200 | 1 / 200 |"));
}

TEST_CASE("Where trials differ, half an interval stands behind the gain; with one trial neither interval nor bold") {
  const auto flown = [](std::vector<double> reference, std::vector<double> better, std::vector<double> worse) {
    return std::vector{
        condition(1, 200,
                  {agent("min-height", "min-height", std::move(reference)),
                   agent("pretrained", "pretrained", std::move(better)), agent("dqn", "dqn", std::move(worse))})};
  };
  // gains 1 and 3: of four resamples one each is all 1 or all 3
  CHECK_THAT(overview(flown({4.0, 6.0}, {5.0, 9.0}, {3.0, 5.0}), {}),
             Contains("| pretrained | **+2.00 ± 1.00** |") && Contains("| dqn | -1.00 |"));
  const auto single = flown({4.0}, {5.0}, {3.0});
  CHECK_THAT(overview(single, {}), Contains("| pretrained | +1.00 |") && !Contains("±") && !Contains("**"));
  CHECK_THAT(tournament_details(single), Contains("| pretrained | 1 | 5.00 | - | +1.00 | - | 100 % |"));
  // One of the two agents has flown once, which is too few to name the best.
  CHECK_THAT(overview(flown({4.0, 6.0}, {5.0, 9.0}, {3.0}), {}), !Contains("**+"));
}

TEST_CASE("The details have a table per condition", "[report]") {
  const std::string text = tournament_details(two_conditions());
  CHECK_THAT(text, Contains("### 1 / 200 per km²") && Contains("### 5 / 200 per km²"));
  CHECK_THAT(text, Contains("| pretrained | 2 | 4.50 | [4.00, 5.00] | +3.00 | - | 100 % | 50 % | 40.0 | "
                            "0.0 | 3.0 | 12.5 |"));
}
