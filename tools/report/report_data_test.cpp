#include "tools/report/report_data.hpp"

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include "common/base/error.hpp"
#include "common/experiment/trial_world.hpp"
#include "tests/integration/command.hpp"
#include "tests/paths.hpp"
#include "tools/report/report.hpp"

using namespace aloft;
using nlohmann::json;

namespace {

using Keep = std::function<bool(const experiment::FlightKey&)>;

bool everything(const experiment::FlightKey& /*key*/) {
  return true;
}

/// Flies all of an experiment for which `keep` is true.
void fly(const experiment::Experiment& experiment, const std::filesystem::path& dir, const Keep& keep) {
  auto results = store::ResultStore::open_for_writing(dir, experiment);
  results.batch([&] {
    for (const experiment::Condition& condition : experiment.conditions)
      for (std::uint32_t trial = 0; trial < experiment.trials; ++trial) {
        const auto map = experiment::make_signal_map(experiment, condition, trial);
        for (const agents::AgentSpec& spec : experiment.agents) {
          const experiment::FlightKey key{condition.index, trial, spec.name};
          if (!keep(key)) continue;
          const auto agent = spec.make();
          results.add(key, store::encode_trace(flight::fly(*map, experiment.seed, trial, *agent, spec,
                                                           experiment.costs_in(condition))));
        }
      }
  });
}

json data_of(const std::filesystem::path& dir, const report::Choice& choice = {}) {
  std::vector<store::ResultStore> runs;
  runs.push_back(store::ResultStore::open_for_reading(dir));
  return report::report_data(runs, choice);
}

/// The report of a shipped experiment with these overrides.
json report_of(const std::string& experiment, const experiment::Overrides& overrides) {
  const test::ScratchDir dir;
  fly(experiment::load(test::source_dir() / "data" / "experiments" / experiment, overrides), dir / "results",
      everything);
  return data_of(dir / "results");
}

json claim_of(const json& data, const std::string& words) {
  for (const json& claim : data["claims"]["all"])
    if (claim["text"].get<std::string>().find(words) != std::string::npos) return claim;
  return nullptr;
}

/// A flight of 3 steps and 3 heights, stored in kbit/s; step s at level k gives 1000 s + 100 k.
constexpr const char* measured_csv =
    "step,height_m,throughput_kbps\n"
    "1,20,1000\n1,30,1100\n1,40,1200\n"
    "2,20,2000\n2,30,2100\n2,40,2200\n"
    "3,20,3000\n3,30,3100\n3,40,3200\n";

/// Two trials of two agents over that flight; flights for which `keep` is true are stored.
class MeasuredRun {
 public:
  explicit MeasuredRun(const Keep& keep) {
    test::write_text(dir_ / "gcq.csv", measured_csv);
    const json document{{"name", "tiny"},
                        {"trials", 2},
                        {"world", {{"kind", "measured"}, {"file", (dir_ / "gcq.csv").string()}}},
                        {"agents", {"constant-40", "min-height"}}};
    fly(experiment::parse(document.dump(), "test"), dir_ / "results", keep);
  }

  [[nodiscard]] json data(const report::Choice& choice = {}) const { return data_of(dir_ / "results", choice); }
  [[nodiscard]] std::filesystem::path dir() const { return dir_ / "results"; }

 private:
  test::ScratchDir dir_;
};

}  // namespace

TEST_CASE("Conditions that differ in the site map alone share a place", "[report]") {
  const test::ScratchDir dir;
  const json document{{"name", "maps"},
                      {"trials", 1},
                      {"world", {{"kind", "generated"}, {"steps", 3}, {"site_map_error_m", {10, 25}}}},
                      {"agents", {"min-height"}}};
  fly(experiment::parse(document.dump(), "test"), dir / "results", everything);
  const json data = data_of(dir / "results");
  CHECK(data["conditions"][0]["label"] == "10 m off");
  CHECK(data["conditions"][1]["parameters"] == json({{"site_map_error_m", 25}}));
  CHECK(data["parameter_titles"] == json({{"site_map_error_m", "Error of the site map (m)"}}));
  for (const json& one : data["conditions"]) CHECK(one["place"] == "2.5 BS per km², 200 buildings per km²");
}

TEST_CASE("The shipped quick experiment has too few trials to be compared with the paper", "[report]") {
  const json data = report_of("quick.json", {.agents = {"min-height", "constant-120", "random-walk"}});
  for (const json& claim : data["claims"]["all"]) {
    CHECK(claim["verdict"] == "not-applicable");
    CHECK_THAT(claim["reason"].get<std::string>(), Catch::Contains("20 trials, at least 30 are needed") &&
                                                       Catch::Contains("not a flight of the paper by its SHA-256"));
  }
  CHECK(data["published"]["left_out"]["all"].size() == 4);
  REQUIRE(data["published"]["rows"].size() == 5);  // of the cities; none of the measured sample
  for (const json& row : data["published"]["rows"]) {
    CHECK(row["views"]["all"]["verdict"] == "not-applicable");
    CHECK(row["views"]["all"]["value"].is_null());
  }
}

TEST_CASE("The shipped bs-density experiment is compared with the paper, as far as it has flown", "[report]") {
  const std::vector<std::string> agents{"min-height", "constant-120", "constant-240", "random-walk", "one-step-ahead"};
  const json data = report_of("bs-density.json", {.agents = agents, .trials = 30});
  CHECK(data["published"]["left_out"]["all"].empty());
  CHECK(data["published"]["rows"].size() == 9);
  for (const json& row : data["published"]["rows"]) CHECK(row["views"]["all"]["verdict"] != "not-applicable");
  const json density = claim_of(data, "higher base-station density");
  CHECK(density["verdict"] != "supported");
  CHECK_THAT(density["reason"].get<std::string>(), Catch::Contains("optimal-height, dqn at 1 / 200"));
  CHECK(claim_of(data, "RL improves")["verdict"] == "not-applicable");
  CHECK(claim_of(data, "building density")["verdict"] == "not-applicable");
}

TEST_CASE("With another beam the shipped bs-density experiment is none of the paper's", "[report]") {
  const json data =
      report_of("bs-density.json", {.set = {"world.uav_beamwidth_deg=60"}, .agents = {"min-height"}, .trials = 1});
  CHECK(data["published"]["rows"].empty());
  for (const json& claim : data["claims"]["all"]) {
    CHECK(claim["verdict"] == "not-applicable");
    CHECK_THAT(claim["reason"].get<std::string>(), Catch::Contains("uav_beamwidth_deg 60 instead of 45"));
  }
}

TEST_CASE("The data block of a measured flight counts in Mbit/s", "[report]") {
  const json data = MeasuredRun(everything).data();
  CHECK(data["missing"].empty());
  CHECK(data["title"] == "tiny");
  CHECK(data["learner"].is_null());
  const json& condition = data["conditions"][0];
  CHECK(condition["qos_unit"] == "Mbit/s");
  CHECK(condition["label"] == "measured flight gcq");
  CHECK(condition["views"]["selected"].is_null());
  const json& shown = condition["views"]["all"]["agents"];
  CHECK(shown[0]["name"] == "min-height");  // the order of display, not of the experiment
  CHECK(shown[0]["mean"] == 2.0);
  CHECK(shown[1]["mean"] == 2.1667);  // (1.1 + 2.2 + 3.2) / 3
  CHECK(shown[1]["gain"]["mean"] == 0.1667);
  CHECK(shown[1]["gain"]["ci95"].is_null());  // the same in both trials
  CHECK(shown[1]["privilege"] == "none");
  CHECK(data["agents"][0]["privilege"] == "none");
  CHECK(data["privilege_tiers"].back()["mark"] == "**");
}

TEST_CASE("The chosen flight shows heights, throughput and what every height would have given", "[report]") {
  const json flight = MeasuredRun(everything).data({"", 1})["conditions"][0]["flight"];
  CHECK(flight["trial"] == 1);
  CHECK(flight["step"] == json({1, 2, 3}));
  CHECK(flight["agents"][1]["height_m"] == json({30, 40, 40}));
  CHECK(flight["agents"][1]["qos"] == json({1.1, 2.2, 3.2}));
  CHECK(flight["agents"][1]["learning"].is_null());
  CHECK(flight["map"]["height_m"] == json({20, 30, 40}));
  CHECK(flight["map"]["qos"] == json({{1.0, 1.1, 1.2}, {2.0, 2.1, 2.2}, {3.0, 3.1, 3.2}}));
  CHECK(flight["city"].is_null());
}

TEST_CASE("An unfinished run names what is missing and shows the flight that most agents flew", "[report]") {
  const MeasuredRun run([](const experiment::FlightKey& key) { return key.trial == 1 || key.agent == "min-height"; });
  const json data = run.data();
  REQUIRE(data["missing"].size() == 1);
  CHECK(data["missing"][0] == "measured flight gcq: 1 of 4 flights are missing: constant-40 (1 of 2)");
  CHECK(data["conditions"][0]["flight"]["trial"] == 1);
  CHECK(data["conditions"][0]["views"]["all"]["agents"][1]["trials"] == 1);

  const json nothing = MeasuredRun([](const experiment::FlightKey&) { return false; }).data();
  CHECK(nothing["conditions"][0]["views"]["all"].is_null());
  CHECK(nothing["conditions"][0]["flight"].is_null());
}

TEST_CASE("A choice that is not there is refused with what is", "[report]") {
  const MeasuredRun run(everything);
  CHECK_THROWS_WITH(run.data({"", 7}), Catch::Contains("no flight of trial 7"));
  CHECK_THROWS_WITH(run.data({"0", 7}), Catch::Contains("0 to 1"));
  CHECK_THROWS_WITH(run.data({"mesured", std::nullopt}), Catch::Contains("'measured'"));
  CHECK_THROWS_AS(run.data({"1", std::nullopt}), InputError);
}

TEST_CASE("A program without charts says so, and how to get them", "[report]") {
  CHECK_NOTHROW(report::require_charts());
  CHECK_THROWS_AS(report::require_charts(""), InputError);
  CHECK_THROWS_WITH(report::require_charts(""),
                    Catch::Contains("built without the charts") && Catch::Contains("tools/setup.sh"));
}

TEST_CASE("A page is one file that its data cannot break", "[report]") {
  const std::string page = report::render_page({{"title", "</script><b>&"}});
  CHECK(page.find("</script><b>") == std::string::npos);
  CHECK(page.find(R"(\u003c/script>\u003cb>&)") != std::string::npos);
  CHECK(page.find("%DATA%") == std::string::npos);
  CHECK(page.find("<script src") == std::string::npos);

  const MeasuredRun run(everything);
  const report::WrittenReport written = report::write_report(run.dir());
  CHECK(written.page == run.dir() / "report.html");
  CHECK_THAT(test::read_text(written.page), Catch::Contains("id=\"report-data\">{\""));
  CHECK_THROWS_WITH(report::write_report(run.dir() / "nowhere"), Catch::Contains("no such folder"));
  CHECK_THROWS_WITH(report::write_report(run.dir(), {.page = run.dir() / "no" / "page.html"}),
                    Catch::Contains("cannot be written"));
}
