#include "common/experiment/schema.hpp"

#include <catch2/catch.hpp>
#include <cstdlib>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "common/base/read_file.hpp"
#include "common/base/write_file.hpp"
#include "common/experiment/experiment.hpp"
#include "common/experiment/testing/schema_validator.hpp"
#include "tests/paths.hpp"

using aloft::read_file;
using aloft::write_file;
using namespace aloft::experiment;
using Json = nlohmann::json;

namespace {

const std::filesystem::path repository = aloft::test::source_dir();

Json& agent_rules(Json& schema) {
  return schema["properties"]["agents"]["items"]["anyOf"][1]["allOf"];
}

}  // namespace

TEST_CASE("data/schema/experiment.schema.json is the schema of the parameter tables") {
  const auto file = repository / "data/schema/experiment.schema.json";
  Json made = experiment_schema();
  if (std::getenv("ALOFT_WRITE_SCHEMA") != nullptr) write_file(file, made.dump(2) + "\n");
  Json shipped = Json::parse(read_file(file));
  // A new agent works without an entry in the shipped schema; an entry that exists must be right.
  const Json rules = agent_rules(shipped);
  Json known = Json::array();
  for (const Json& rule : agent_rules(made))
    for (const Json& other : rules)
      if (other["if"] == rule["if"]) known.push_back(rule);
  agent_rules(made) = known;
  INFO("ALOFT_WRITE_SCHEMA=1 build/bin/aloft_experiment_tests '[schema]' or the whole program writes it anew");
  CHECK(Json::diff(shipped, made) == Json::array());
}

TEST_CASE("the schema accepts the shipped experiments and their resolved forms") {
  for (const auto& entry : std::filesystem::directory_iterator(repository / "data/experiments")) {
    INFO(entry.path());
    CHECK(schema_errors(Json::parse(read_file(entry.path()))).empty());
    CHECK(schema_errors(load(entry.path()).canonical) == std::vector<std::string>{});
  }
}

TEST_CASE("the schema refuses what an editor should underline") {
  const Json good = Json::parse(R"({"name": "x", "trials": 1, "world": {}, "agents": ["min-height"]})");
  REQUIRE(schema_errors(good).empty());
  const auto refused = [&](const char* path, const Json& value) {
    Json bad = good;
    bad[Json::json_pointer(path)] = value;
    return !schema_errors(bad).empty();
  };
  CHECK(refused("/trials", 0));
  CHECK(refused("/trails", 1));
  CHECK(refused("/seed", -1));
  CHECK_FALSE(refused("/seed", 18446744073709551615U));
  CHECK(refused("/on_agent_loss", "retry"));
  CHECK(refused("/world/bs_density_per_km2", -1));
  CHECK(refused("/world/bs_density_per_km2", Json::array()));
  CHECK(refused("/world/bs_density_per_km2", Json::array({1, 1})));
  CHECK_FALSE(refused("/world/bs_density_per_km2", Json::array({1, 2.5})));
  CHECK(refused("/world/file", "flight.csv"));
  CHECK(refused("/world", Json{{"kind", "measured"}}));
  CHECK(refused("/worlds", Json::array({Json::object()})));  // beside "world"
  CHECK(refused("/agents", Json::array()));
  CHECK(refused("/agents/0", Json{{"type", "dqn"}, {"discount", 2}}));
  CHECK_FALSE(refused("/agents/0", Json{{"type", "dqn"}, {"discount", 0.5}}));
  CHECK_FALSE(refused("/agents/0", Json{{"type", "somebodys-agent"}, {"speed", 2}}));
}

TEST_CASE("schema errors name the JSON path") {
  const Json bad = Json::parse(R"({"name": "x", "trials": 0, "world": {}, "agents": ["min-height"]})");
  const auto errors = schema_errors(bad);
  REQUIRE(errors.size() == 1);
  CHECK(errors[0].starts_with("trials: "));
}
