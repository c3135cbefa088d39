#include "services/environment/world_maker.hpp"

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>
#include <string>

#include "common/bus/validate.hpp"
#include "common/radio/generated_world.hpp"

using namespace aloft;

namespace {

/// The world that is made for the first trial of an experiment.
wire::World made_in(const nlohmann::json& world) {
  experiment::Experiment experiment =
      experiment::parse(R"({"name": "x", "trials": 1, "world": {}, "agents": ["min-height"]})", "test");
  std::vector<ParameterSpec> table = radio::generated_world_parameters();  // with wider ranges: impossible worlds, too
  for (ParameterSpec& spec : table)
    if (spec.kind == ParameterSpec::Kind::number) spec.maximum = 1e9;
  experiment.conditions[0].world = Parameters(table, world, "world");
  wire::TrialAssignment assignment;
  assignment.agents(wire::names({"min-height"}));
  return environment::WorldMaker(experiment).make(assignment);
}

}  // namespace

TEST_CASE("a world is made for a trial") {
  const wire::World world = made_in(nlohmann::json::object());
  CHECK(world.kind() == wire::WORLD_CITY);
  CHECK(bus::validate(world) == nullptr);
}

TEST_CASE("a world that cannot be made or sent fails its trial, not the process") {
  for (const auto& [given, reason] :
       {std::pair{nlohmann::json{{"bs_density_per_km2", 1e5}}, "at most 65536"},
        std::pair{nlohmann::json{{"base_station_height_m", 1e6}}, "height_m out of range"}}) {
    const wire::World world = made_in(given);
    CHECK(world.kind() == wire::WORLD_FAILED);
    CHECK_THAT(std::string(wire::view(world.error())), Catch::Contains(reason));
    CHECK(bus::validate(world) == nullptr);
    CHECK(world.city().base_stations().empty());
  }
}
