#include "common/experiment/warnings.hpp"

#include <unistd.h>

#include <catch2/catch.hpp>
#include <filesystem>
#include <fstream>

#include "common/base/error.hpp"
#include "common/base/read_file.hpp"
#include "common/base/write_file.hpp"
#include "common/experiment/identity.hpp"
#include "tests/paths.hpp"

using namespace aloft;
using namespace aloft::experiment;
using Catch::Contains;

namespace {

Experiment over(const std::string& world, const std::string& more = "", const std::string& agents = "\"pretrained\"") {
  return parse(R"({"name": "x", "trials": 1, )" + more + R"("world": )" + world + R"(, "agents": ["min-height", )" +
                   agents + "]}",
               "test");
}

struct Folder {
  Folder() { std::filesystem::create_directories(path); }
  ~Folder() { std::filesystem::remove_all(path); }
  std::filesystem::path path =
      std::filesystem::temp_directory_path() / ("aloft_warnings_test-" + std::to_string(getpid()));
};

std::string flight_csv(int steps, int heights) {
  std::string csv = "step,height_m,throughput_kbps\n";
  for (int step = 1; step <= steps; ++step)
    for (int k = 0; k < heights; ++k)
      csv += std::to_string(step) + "," + std::to_string(20 + 10 * k) + "," + std::to_string(1000 * (step + k)) + "\n";
  return csv;
}

}  // namespace

TEST_CASE("worlds like those of training give no warning, others name every difference") {
  CHECK(warnings(over(R"({"bs_density_per_km2": [1, 2.5, 5], "building_density_per_km2": [100, 300]})")).empty());
  CHECK(warnings(over(R"({"height_resolution_m": 10})")).empty());
  CHECK(warnings(over(R"({"preset": "geometric"})", "", "\"dqn\"")).empty());  // it learns in flight

  const auto geometric = warnings(over(R"({"preset": "geometric"})"));
  REQUIRE(geometric.size() == 1);
  CHECK(geometric[0].agent == "pretrained");
  CHECK_THAT(geometric[0].text, Contains("los_ray \"geometric\" instead of \"published\"") &&
                                    Contains("building_height_distribution") && !Contains("preset"));
  const auto capped = warnings(over(R"({"spectral_efficiency_max": 7.4})"));
  REQUIRE(capped.size() == 1);
  CHECK_THAT(capped[0].text, Contains("spectral_efficiency_max 7.4 instead of 0"));
  const auto dense = warnings(over(R"({"bs_density_per_km2": [5, 8], "height_max_m": 120})"));
  REQUIRE(dense.size() == 2);
  CHECK_THAT(dense[0].text, Contains("bs_density_per_km2=5") && Contains("height_max_m 120 instead of 240"));
  CHECK_THAT(dense[1].text, Contains("bs_density_per_km2 8 instead of 1 to 5"));
}

TEST_CASE("agents foresee the strongest cell, which need not be the one that serves") {
  const auto found = warnings(over(R"({"serving": ["strongest", "a3"]})", "", R"("planner", "dqn", "pretrained")"));
  REQUIRE(found.size() == 2);
  CHECK(found[0].agent == "pretrained");
  CHECK_THAT(found[0].text, Contains("condition 'serving=a3'") && Contains("serving \"a3\" instead of \"strongest\""));
  CHECK(found[1].agent == "planner");
  CHECK_THAT(found[1].text, Contains("foresees the quality of the strongest cell") &&
                                Contains("in condition 'serving=a3' the cell that serves depends on the flight"));
  CHECK(warnings(over("{}", "", "\"planner\"")).empty());
}

TEST_CASE("height-filter warns of generated worlds that its prior was not fitted to, unless it was given another one") {
  const std::string filter = "\"height-filter\"";
  CHECK(warnings(over(R"({"bs_density_per_km2": [1, 5]})", "", filter)).empty());
  const auto urban = warnings(over(R"({"preset": "3gpp-uma"})", "", filter));
  REQUIRE(urban.size() == 1);
  CHECK(urban[0].agent == "height-filter");
  CHECK_THAT(urban[0].text, Contains("agent 'height-filter': its prior was not fitted to condition") &&
                                Contains("propagation \"uma-av\" instead of \"power-law\"") &&
                                Contains("expect less of it there"));
  CHECK(warnings(over(R"({"preset": "3gpp-uma"})", "", R"({"type": "height-filter", "se_mean": 0.3})")).empty());
  const auto both = warnings(over(R"({"preset": "3gpp-uma"})", "", filter + ", \"pretrained\""));
  CHECK(both.size() == 2);
}

TEST_CASE("the same warning about several conditions is one") {
  const auto sweep = warnings(over(R"({"bs_density_per_km2": [6, 7, 8, 9, 10, 11, 12, 13, 14, 15]})"));
  REQUIRE(sweep.size() == 1);
  CHECK_THAT(sweep[0].text,
             Contains("conditions 'bs_density_per_km2=6', 'bs_density_per_km2=7', "
                      "'bs_density_per_km2=8' and 7 more: bs_density_per_km2 6 to 15 instead of 1 to 5"));
  // Conditions with different kinds of differences get a warning each.
  CHECK(warnings(over(R"({"bs_density_per_km2": [6, 7], "los_ray": ["published", "geometric"]})")).size() == 2);
}

TEST_CASE("measured flights: size, and costs that they cannot charge") {
  const Folder folder;
  const auto file = folder.path / "flight.csv";
  const std::string world = R"({"kind": "measured", "file": ")" + file.string() + "\"}";
  write_file(file, flight_csv(130, 11));
  CHECK(warnings(over(world)).empty());
  const auto costs = warnings(over(world, R"("handover_cost": 1, )"));
  REQUIRE(costs.size() == 1);
  CHECK(costs[0].agent.empty());
  CHECK_THAT(costs[0].text, Contains("without serving_cell"));
  CHECK(warnings(over(world, R"("handover_loss": 0.5, )")).size() == 1);
  write_file(file, flight_csv(12, 3));
  const auto small = warnings(over(world));
  REQUIRE(small.size() == 1);
  CHECK_THAT(small[0].text, Contains("heights 3 instead of 8 to 16, steps 12 instead of 120 to 200"));
  CHECK(warnings(over(world, "", "\"height-filter\"")).empty());
}

TEST_CASE("a model file counts by its content, wherever it lies; a report does not need it") {
  const Folder folder;
  const auto with_model = [&](const std::filesystem::path& file) {
    return over("{}", "", R"({"type": "pretrained", "model": ")" + file.string() + "\"}");
  };
  const auto shipped = aloft::test::source_dir() / "data/models/pretrained.pb";
  std::filesystem::copy_file(shipped, folder.path / "copy.pb");
  const Experiment one = with_model(shipped);
  const Experiment other = with_model(folder.path / "copy.pb");
  CHECK(one.id == other.id);
  CHECK(one.id != over("{}").id);  // a later Aloft can have another built-in model
  const std::string sha256 = one.agent("pretrained").parameters.text("model_sha256");
  CHECK(sha256.size() == 64);

  const std::string canonical = other.canonical.dump();
  std::filesystem::remove(folder.path / "copy.pb");
  CHECK(parse(canonical, "wire").id == one.id);
  write_file(folder.path / "resolved.json", canonical);
  CHECK_THROWS_WITH(load(folder.path / "resolved.json"), Contains("copy.pb"));

  // Another content under the old SHA-256, a damaged file, and none.
  write_file(folder.path / "copy.pb", read_file(shipped) + "x");
  CHECK_THROWS_WITH(load(folder.path / "resolved.json"), Contains("SHA-256"));
  CHECK_THROWS_AS(with_model(folder.path / "copy.pb"), InputError);
  CHECK_THROWS_AS(with_model(folder.path / "none.pb"), InputError);
}
