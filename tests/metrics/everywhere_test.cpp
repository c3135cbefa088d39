// A metric is one row of the table (common/flight/metrics.hpp): these tests add rows and look for them wherever flights
// are stored and shown.
#include <SQLiteCpp/SQLiteCpp.h>

#include <algorithm>
#include <catch2/catch.hpp>
#include <cstdio>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "common/base/error.hpp"
#include "common/base/read_file.hpp"
#include "common/experiment/summary.hpp"
#include "common/flight/metrics.hpp"
#include "common/store/result_store.hpp"
#include "tests/integration/command.hpp"
#include "tests/paths.hpp"
#include "tools/export/rows.hpp"
#include "tools/reference/pages.hpp"
#include "tools/report/report_data.hpp"

using namespace aloft;
using Catch::Contains;
using flight::FlightRecord;
using flight::Metric;

namespace {

double height_max_m(const FlightRecord& record) {
  double max_m = 0.0;
  for (const flight::StepRecord& step : record.steps) max_m = std::max(max_m, step.height_m);
  return max_m;
}

/// Adds two metrics as long as it lives: a real number with a unit, and a count that is unknown for most flights.
class MoreMetrics {
 public:
  MoreMetrics() {
    table_.push_back(
        {.key = "height_max_m",
         .mean_key = "height_max_mean_m",
         .name = "greatest height",
         .heading = "top km",
         .description = "The greatest height.",
         .value = [](const FlightRecord& record, const flight::Costs&) { return std::optional(height_max_m(record)); },
         .unit = {"m", "km", 1000.0},
         .decimals = 3,
         .overview_decimals = 4});
    table_.push_back({.key = "steps_at_top",
                      .mean_key = "steps_at_top_mean",
                      .name = "steps at the top",
                      .heading = "at top",
                      .description = "Steps above 100 m.",
                      .value = [](const FlightRecord& record, const flight::Costs&) -> std::optional<double> {
                        if (height_max_m(record) < 100.0) return std::nullopt;
                        return std::count_if(record.steps.begin(), record.steps.end(),
                                             [](const auto& step) { return step.height_m > 100.0; });
                      },
                      .integer = true,
                      .optional = true});
  }
  ~MoreMetrics() { table_.resize(table_.size() - 2); }
  MoreMetrics(const MoreMetrics&) = delete;
  MoreMetrics& operator=(const MoreMetrics&) = delete;

 private:
  std::vector<Metric>& table_ = flight::testing::metric_table();
};

/// Two steps at `height_m` after a start at 40 m.
std::string flight_at(double height_m) {
  FlightRecord record;
  record.height_start_m = 40.0;
  record.pilots = {"someone"};
  for (std::uint32_t step = 1; step <= 2; ++step)
    record.steps.push_back({step, agents::Action::up, 10.0 * step, 0.0, height_m, 3, 1.0, 2.0, 2.0, 0, {}});
  return store::encode_trace(record);
}

experiment::Experiment small() {
  return experiment::parse(
      R"({"name": "small", "trials": 2, "world": {"bs_density_per_km2": 5}, "agents": ["min-height", "constant-120"]})",
      "test");
}

std::string exported(const std::filesystem::path& dir, exports::RowFormat format) {
  const auto results = store::ResultStore::open_for_reading(dir);
  const std::filesystem::path file = dir / "export.txt";
  std::FILE* out = std::fopen(file.c_str(), "w");
  REQUIRE(out != nullptr);
  exports::write_rows(results, results.flights(), exports::Rows::flights, format, out);
  std::fclose(out);
  return read_file(file);
}

/// The flights of version 0.2.0.
std::filesystem::path old_results(const test::ScratchDir& scratch) {
  std::filesystem::copy(test::source_dir() / "tests/golden/results-0.2.0/interrupted", scratch / "old");
  return scratch / "old";
}

/// Checks that every flight has the metrics of its trace.
void check_more_metrics(const store::ResultStore& results) {
  REQUIRE(results.count() == 21);
  for (const store::FlightSummary& flight : results.flights()) {
    const FlightRecord record = store::decode_trace(results.trace(flight.key));
    CHECK(flight.metrics["height_max_m"] == height_max_m(record));
    CHECK(flight.metrics["steps_at_top"].has_value() == (height_max_m(record) >= 100.0));
    CHECK(flight.metrics["qos_mean"] == record.qos_mean());
  }
}

void run_sql(const std::filesystem::path& dir, const std::string& sql) {
  SQLite::Database((dir / "results.sqlite").string(), SQLite::OPEN_READWRITE).exec(sql);
}

int format_of(const std::filesystem::path& dir) {
  SQLite::Database database((dir / "results.sqlite").string(), SQLite::OPEN_READONLY);
  return database.execAndGet("PRAGMA user_version").getInt();
}

}  // namespace

TEST_CASE("a metric of the table is in the database, summaries, exports, tables, reports and the reference") {
  const test::ScratchDir scratch;
  const MoreMetrics more;
  const std::filesystem::path dir = scratch / "new";
  {
    auto results = store::ResultStore::open_for_writing(dir, small());
    for (std::uint32_t trial = 0; trial < 2; ++trial) {
      (void)results.add({0, trial, "min-height"}, flight_at(40.0));
      (void)results.add({0, trial, "constant-120"}, flight_at(120.0));
    }
  }
  store::write_summary(dir);
  CHECK(format_of(dir) == 4);
  {
    SQLite::Database database((dir / "results.sqlite").string(), SQLite::OPEN_READONLY);
    CHECK(database.execAndGet("SELECT sum(height_max_m) FROM flight").getDouble() == 320.0);
    CHECK(database.execAndGet("SELECT count(*) FROM flight WHERE steps_at_top IS NULL").getInt() == 2);
  }

  const auto summary = nlohmann::ordered_json::parse(read_file(dir / "summary.json"));
  const auto& agents = summary["conditions"][0]["agents"];
  CHECK(agents["constant-120"]["height_max_mean_m"] == 120.0);
  CHECK(agents["constant-120"]["steps_at_top_mean"] == 2.0);
  CHECK(agents["min-height"]["steps_at_top_mean"].is_null());
  CHECK_THAT(read_file(dir / "summary.csv"), Contains(",outage_mean_s,height_max_mean_m,steps_at_top_mean,gain_over_"));
  CHECK_THAT(experiment::summary_table(summary), Contains("top km  at top") && Contains("  0.120     2.0"));

  CHECK_THAT(exported(dir, exports::RowFormat::csv),
             Contains(",outage_s,height_max_m,steps_at_top,digest\n") && Contains(",120.0,2,") && Contains(",40.0,,"));
  CHECK(nlohmann::json::parse(exported(dir, exports::RowFormat::json))[1]["steps_at_top"] == 2);

  std::vector<store::ResultStore> runs;
  runs.push_back(store::ResultStore::open_for_reading(dir));
  const nlohmann::json data = report::report_data(runs, {});
  const nlohmann::json& last = data["metrics"].back();
  CHECK(last["title"] == "Steps at the top");
  CHECK(data["metrics"][data["metrics"].size() - 2]["title"] == "Greatest height (km)");
  CHECK(data["conditions"][0]["views"]["all"]["agents"][1]["metrics"]["greatest height"] == 0.12);
  CHECK(data["conditions"][0]["views"]["all"]["agents"][0]["metrics"]["steps at the top"].is_null());

  const auto pages = reference::pages();
  CHECK(std::any_of(pages.begin(), pages.end(), [](const auto& page) {
    return page.text.find("| `height_max_m` | REAL NOT NULL | The greatest height. |") != std::string::npos;
  }));
}

TEST_CASE("metrics that a database of version 0.2.0 lacks are computed from its traces") {
  const test::ScratchDir scratch;
  const std::filesystem::path dir = old_results(scratch);
  const std::string digest = store::ResultStore::open_for_reading(dir).digest();
  const std::string before = read_file(dir / "results.sqlite");
  const MoreMetrics more;
  const auto results = store::ResultStore::open_for_reading(dir);
  check_more_metrics(results);
  CHECK(results.digest() == digest);
  CHECK(read_file(dir / "results.sqlite") == before);
  run_sql(dir, "UPDATE trace SET bytes = (SELECT bytes FROM trace WHERE flight = 1) WHERE flight = 0");
  CHECK_THROWS_AS(results.flights(), IntegrityError);
}

TEST_CASE("a database of version 0.2.0 that is written again gets the columns that it lacks, under new seals") {
  const test::ScratchDir scratch;
  const std::filesystem::path dir = old_results(scratch);
  const auto before = store::ResultStore::open_for_reading(dir);
  const std::string digest = before.digest();
  CHECK(format_of(dir) == 3);
  {
    const MoreMetrics more;
    { (void)store::ResultStore::open_for_writing(dir, before.experiment()); }
    CHECK(format_of(dir) == 4);
    check_more_metrics(before);  // a store that was open before can still be read
    const auto after = store::ResultStore::open_for_reading(dir);
    check_more_metrics(after);
    CHECK(after.digest() == digest);
    CHECK(after.count() == 21);
  }
  // Programs without these metrics can read this database of a newer version, but not write it.
  const auto after = store::ResultStore::open_for_reading(dir);
  CHECK(after.digest() == digest);
  CHECK_THROWS_WITH(store::ResultStore::open_for_writing(dir, before.experiment()),
                    Contains("newer Aloft") && Contains("'height_max_m'"));
  run_sql(dir, "UPDATE flight SET height_max_m = height_max_m + 1 WHERE id = 4");
  CHECK_THROWS_WITH(after.flights(), Contains("row 4 of table flight was altered"));
}

TEST_CASE("an upgrade that fails changes nothing") {
  const test::ScratchDir scratch;
  const std::filesystem::path dir = old_results(scratch);
  const experiment::Experiment experiment = store::ResultStore::open_for_reading(dir).experiment();
  run_sql(dir, "UPDATE trace SET bytes = x'00' WHERE flight = (SELECT max(flight) FROM trace)");
  {
    const MoreMetrics more;
    CHECK_THROWS_AS(store::ResultStore::open_for_writing(dir, experiment), IntegrityError);
  }
  CHECK(format_of(dir) == 3);
  CHECK(store::ResultStore::open_for_reading(dir).count() == 21);  // their metrics need the traces
}
