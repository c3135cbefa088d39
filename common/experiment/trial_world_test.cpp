#include "common/experiment/trial_world.hpp"

#include <catch2/catch.hpp>

namespace aloft::experiment {
namespace {

using Catch::Contains;

const Experiment& test_experiment() {
  static const Experiment experiment =
      parse(R"({"name": "test", "trials": 2, "world": {"steps": 5, "min_base_stations": 9}, "agents": ["min-height"]})",
            "test");
  return experiment;
}

}  // namespace

TEST_CASE("a signal map over a world that was passed in equals the trial's own") {
  const Experiment& experiment = test_experiment();
  const Condition& condition = experiment.conditions[0];
  const auto direct = make_signal_map(experiment, condition, 1);
  const auto sent = make_signal_map(experiment, condition, 1, make_world(experiment, condition, 1));
  const std::uint32_t last = direct->result_point(direct->steps());
  const auto qualities = [&](radio::SignalMap& map) {
    std::vector<double> all;
    for (const radio::Reading& reading : map.column(last, map.start())) all.push_back(reading.qos);
    return all;
  };
  CHECK(qualities(*direct) == qualities(*sent));
}

TEST_CASE("a world that cannot be one of the condition is refused") {
  const Experiment& experiment = test_experiment();
  const Condition& condition = experiment.conditions[0];
  CHECK_THROWS_WITH(make_signal_map(experiment, condition, 0, world::MeasuredWorld()),
                    Contains("not of the condition's kind"));
  world::City city = make_city(experiment, condition, 0);
  city.base_stations.resize(8);
  CHECK_THROWS_WITH(make_signal_map(experiment, condition, 0, city), Contains("fewer base stations"));
  Condition measured = condition;
  measured.kind = WorldKind::measured;
  CHECK_THROWS_WITH(make_signal_map(experiment, measured, 0, make_city(experiment, condition, 0)),
                    Contains("not of the condition's kind"));
}

}  // namespace aloft::experiment
