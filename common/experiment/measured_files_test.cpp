// Base stations beside a measured flight: where they are looked for, what counts, what is refused, and how
// site-planner flies by them.
#include "common/experiment/measured_files.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <catch2/catch.hpp>
#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>

#include "common/base/error.hpp"
#include "common/base/write_file.hpp"
#include "common/experiment/experiment.hpp"
#include "common/experiment/trial_world.hpp"
#include "common/flight/flight.hpp"
#include "common/radio/expected_field.hpp"

namespace aloft::experiment {
namespace {

using Catch::Contains;

const std::string some_sites =
    "cell,latitude,longitude,antenna_height_m\n1,45.001,-6.002,18\n2,45.004,-5.996,20\n3,45.007,-6.003,22\n";
const std::string other_sites = "cell,latitude,longitude,antenna_height_m\n1,45.001,-6.001,18\n";

/// Ten steps to the north, 20 to 60 m high, best where it is lowest.
std::string flight_csv(bool with_places) {
  std::string csv = fmt::format("step,height_m,throughput_kbps{}\n", with_places ? ",latitude,longitude" : "");
  for (int step = 1; step <= 10; ++step)
    for (int height_m = 20; height_m <= 60; height_m += 10)
      csv += fmt::format("{},{},{}{}\n", step, height_m, 50'000 - 100 * height_m,
                         with_places ? fmt::format(",{},-6.0", 45.0 + 1e-3 * step) : "");
  return csv;
}

/// Four by four base stations around the flight, 18 to 21 m high.
std::string many_sites() {
  std::string csv = "cell,latitude,longitude,antenna_height_m\n";
  for (int row = 0; row < 4; ++row)
    for (int column = 0; column < 4; ++column)
      csv += fmt::format("{},{},{},{}\n", 4 * row + column, 45.0 + 3e-3 * row, -6.004 + 2.7e-3 * column, 18 + row);
  return csv;
}

/// A folder with a measured flight in it.
class Folder {
 public:
  explicit Folder(bool with_places = true) {
    std::filesystem::create_directories(path_);
    write("flight.csv", flight_csv(with_places));
  }
  ~Folder() { std::filesystem::remove_all(path_); }
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;

  void write(const std::string& name, const std::string& text) const { write_file(path_ / name, text); }
  void remove(const std::string& name) const { std::filesystem::remove(path_ / name); }
  [[nodiscard]] std::string file(const std::string& name) const { return (path_ / name).string(); }

  [[nodiscard]] std::string json(const std::string& agents, const std::string& more = "") const {
    return fmt::format(
        R"({{"name": "m", "trials": 1, "world": {{"kind": "measured", "file": "{}"{}}}, "agents": [{}]}})",
        file("flight.csv"), more, agents);
  }
  [[nodiscard]] Experiment parsed(const std::string& agents = R"("site-planner")", const std::string& more = "") const {
    return parse(json(agents, more), "my.json");
  }
  [[nodiscard]] std::string message(const std::string& agents = R"("site-planner")",
                                    const std::string& more = "") const {
    try {
      (void)parsed(agents, more);
    } catch (const InputError& error) {
      return error.what();
    }
    return "accepted";
  }

 private:
  std::filesystem::path path_ =
      std::filesystem::temp_directory_path() / fmt::format("aloft-measured-files-test-{}", ::getpid());
};

std::string sites_file(const Experiment& experiment) {
  return experiment.conditions.at(0).world.text("sites_file");
}

}  // namespace

TEST_CASE("an agent with the site map is refused over a measured flight without base stations, by name of the files") {
  const Folder folder;
  const std::string own = folder.file("flight.sites.csv");
  CHECK_THAT(folder.message(), Contains("my.json: world.file: " + folder.file("flight.csv") +
                                        ": agent 'site-planner' needs the base stations: " + own + " or " +
                                        folder.file("sites.csv") + " is missing; add it (columns cell, latitude"));
  CHECK_THAT(folder.message(R"({"type": "external", "name": "visitor", "privilege": "site-map"})"),
             Contains("agent 'visitor' needs"));
  const std::string crew =
      R"({"type": "relay", "name": "both", "crew": [{"agent": "min-height"}, {"agent": "site-planner", "from_step": 5}]})";
  CHECK_THAT(folder.message(crew), Contains("agent 'both' needs"));
  CHECK(folder.message(R"("min-height", "planner")") == "accepted");
  CHECK_THAT(folder.message(R"("min-height")", R"(, "sites_file": "/nowhere/s.csv")"),
             Contains("world.sites_file: cannot read '/nowhere/s.csv'"));
}

TEST_CASE("base stations are those that are named, or those of the flight, or those of its folder") {
  const Folder folder;
  folder.write("sites.csv", some_sites);
  CHECK(sites_file(folder.parsed()) == folder.file("sites.csv"));
  folder.write("flight.sites.csv", other_sites);
  CHECK(sites_file(folder.parsed()) == folder.file("flight.sites.csv"));
  folder.write("mine.csv", some_sites);
  const std::string named = fmt::format(R"(, "sites_file": "{}")", folder.file("mine.csv"));
  CHECK(sites_file(folder.parsed(R"("site-planner")", named)) == folder.file("mine.csv"));
  folder.write("experiment.json", R"({"name": "m", "trials": 1, "agents": ["site-planner"],
    "world": {"kind": "measured", "file": "flight.csv", "sites_file": "mine.csv"}})");
  CHECK(sites_file(load(folder.file("experiment.json"))) == folder.file("mine.csv"));
}

TEST_CASE("base stations count by their content, and only if an agent needs them") {
  const Folder folder;
  const std::string agent = R"("min-height")";
  const Experiment without = folder.parsed(agent);
  folder.write("sites.csv", "no base stations\n");
  CHECK(folder.parsed(agent).id == without.id);
  CHECK(folder.parsed(agent).canonical == without.canonical);
  CHECK_FALSE(without.canonical["worlds"][0].contains("sites_file"));

  folder.write("sites.csv", some_sites);
  const Experiment before = folder.parsed();
  CHECK(before.canonical["worlds"][0]["sites_file_sha256"].get<std::string>().size() == 64);
  folder.write("flight.sites.csv", some_sites);
  CHECK(folder.parsed().id == before.id);
  folder.write("flight.sites.csv", other_sites);
  CHECK(folder.parsed().id != before.id);
}

TEST_CASE("base stations that changed under a resolved experiment are refused, missing ones only when needed") {
  const Folder folder;
  folder.write("sites.csv", some_sites);
  const Experiment before = folder.parsed();
  const std::string canonical = before.canonical.dump();
  CHECK(parse(canonical, "wire").canonical == before.canonical);
  CHECK(make_signal_map(before, before.conditions[0], 0)->survey()->map.sites.size() == 3);
  folder.write("sites.csv", other_sites);
  CHECK(parse(canonical, "wire").id == before.id);
  CHECK_THROWS_WITH(make_signal_map(before, before.conditions[0], 0), Contains("has changed") && Contains("sites.csv"));
  folder.write("resolved.json", canonical);
  CHECK_THROWS_WITH(load(folder.file("resolved.json")),
                    Contains("worlds[0].sites_file") && Contains("remove sites_file_sha256"));
  folder.remove("sites.csv");
  CHECK(parse(canonical, "wire").id == before.id);
}

TEST_CASE("bad base stations, and flights that do not fit them, are refused when the experiment is read") {
  const Folder folder;
  folder.write("sites.csv", "cell,latitude,longitude,antenna_height_m\n1,45,-6,0.5\n");
  CHECK_THAT(folder.message(), Contains("my.json: world.sites_file: " + folder.file("sites.csv") +
                                        ":2:9: antenna_height_m is '0.5'; use a number from 1 to 200"));
  folder.write("sites.csv", some_sites);
  CHECK(folder.message() == "accepted");
  folder.write("flight.csv", flight_csv(false));
  CHECK_THAT(folder.message(), Contains(folder.file("flight.csv") + ": ") && Contains("latitude and longitude"));
  folder.write("flight.csv",
               "step,height_m,throughput_kbps,latitude,longitude\n1,20,1,45,-6\n1,30,1,45,-6\n2,20,1,46,-6\n"
               "2,30,1,46,-6\n");
  CHECK_THAT(folder.message(), Contains("sites.csv:2:3: ") && Contains("from the middle of the route"));
  folder.write("sites.csv", "cell,latitude,longitude,antenna_height_m\n1,45.5,-6,30\n");
  CHECK_THAT(folder.message(), Contains("flight.csv: step 1 is 56 km from the middle of the route"));
  folder.write("flight.csv", "step,height_m,throughput_kbps,latitude,longitude\n1,0,1,45.5,-6\n1,10,1,45.5,-6\n");
  CHECK_THAT(folder.message(), Contains("flight.csv: ") && Contains("height_min_m: 0") && Contains("site map"));
}

TEST_CASE("site-planner flies over a measured flight by its base stations") {
  const Folder folder;
  folder.write("sites.csv", many_sites());
  const Experiment experiment = folder.parsed(R"({"type": "site-planner", "ignored_blocking": 1})");
  const Condition& condition = experiment.conditions[0];
  const auto map = make_signal_map(experiment, condition, 0);
  const agents::AgentSpec& spec = experiment.agents[0];
  const flight::FlightRecord record =
      flight::fly(*map, experiment.seed, 0, *spec.make(), spec, experiment.costs_in(condition));
  REQUIRE(record.steps.size() == 10);
  CHECK(record.steps[0].y_m == Approx(-500.1).margin(0.1));  // 4.5 steps of 111.13 m before the middle
  CHECK(record.steps[9].y_m == Approx(500.1).margin(0.1));

  // With line of sight everywhere, its sum of expectations is that of the best flight, so no smaller than of these.
  radio::ExpectedField field(map->survey()->radio, map->survey()->map.sites);
  REQUIRE(field.levels() == 5);
  double flown = 0.0;
  double lowest = 0.0;
  double second = 0.0;
  std::vector<double> column(field.levels());
  for (const flight::StepRecord& step : record.steps) {
    field.column({step.x_m, step.y_m}, column.data());
    flown += column[static_cast<std::size_t>(std::lround((step.height_m - 20.0) / 10.0))];
    lowest += column[0];
    second += column[1];
  }
  CHECK(flown > lowest);
  CHECK(flown >= second);
  CHECK(lowest > 0.0);
}

}  // namespace aloft::experiment
