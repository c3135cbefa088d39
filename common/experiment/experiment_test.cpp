#include "common/experiment/experiment.hpp"

#include <rapidcheck.h>
#include <unistd.h>

#include <catch2/catch.hpp>
#include <set>

#include "common/base/write_file.hpp"
#include "common/experiment/identity.hpp"
#include "common/experiment/trial_world.hpp"
#include "tests/paths.hpp"

using namespace aloft;
using namespace aloft::experiment;
using Catch::Contains;
using Json = nlohmann::json;

namespace {

const std::filesystem::path source_dir = aloft::test::source_dir();

Experiment parsed(const std::string& world, const std::string& more = "", const Overrides& overrides = {}) {
  return parse(R"({"name": "test", "trials": 2, "agents": ["min-height", "constant-120"], )" + more + world + "}",
               "test", overrides);
}

std::vector<std::string> condition_names(const Experiment& experiment) {
  std::vector<std::string> names;
  for (const Condition& condition : experiment.conditions) names.push_back(condition.name);
  return names;
}

std::vector<std::string> agent_names(const Experiment& experiment) {
  std::vector<std::string> names;
  for (const auto& agent : experiment.agents) names.push_back(agent.name);
  return names;
}

/// A measured flight in a folder of its own.
struct Flight {
  std::filesystem::path folder =
      std::filesystem::temp_directory_path() / ("aloft-experiment-test-" + std::to_string(::getpid()));
  std::filesystem::path csv = folder / "flight.csv";

  Flight() {
    std::filesystem::create_directories(folder);
    write("step,height_m,throughput_kbps\n1,20,100\n1,30,200\n2,20,300\n2,30,400\n");
  }
  ~Flight() { std::filesystem::remove_all(folder); }
  void write(const std::string& text) const { write_file(csv, text); }
  [[nodiscard]] std::string world() const {
    return R"("world": {"kind": "measured", "file": ")" + csv.string() + R"("})";
  }
};

}  // namespace

TEST_CASE("a world without lists is one condition with every default filled in") {
  const Experiment experiment = parsed(R"("world": {})");
  REQUIRE(experiment.conditions.size() == 1);
  const Condition& condition = experiment.conditions.front();
  CHECK(condition.name == "generated");
  CHECK(condition.parameters.empty());
  CHECK(condition.kind == WorldKind::generated);
  CHECK(condition.world.number("bs_density_per_km2") == 2.5);
  CHECK(condition.world.text("los_ray") == "published");
  CHECK(experiment.seed == 1);
  CHECK(experiment.max_attempts == 3);
  CHECK(experiment.on_agent_loss == OnAgentLoss::restart);
  CHECK(experiment.canonical["worlds"][0]["los_ray"] == "published");
  CHECK(experiment.canonical["agents"][1]["height_m"] == 120);
}

TEST_CASE("lists are swept in the order of the file's keys, the first slowest") {
  const Experiment experiment = parsed(
      R"("world": {"building_density_per_km2": [100, 300], "kind": "generated", "bs_density_per_km2": [5, 1, 2.50]})");
  CHECK(condition_names(experiment) == std::vector<std::string>{"building_density_per_km2=100 bs_density_per_km2=5",
                                                                "building_density_per_km2=100 bs_density_per_km2=1",
                                                                "building_density_per_km2=100 bs_density_per_km2=2.5",
                                                                "building_density_per_km2=300 bs_density_per_km2=5",
                                                                "building_density_per_km2=300 bs_density_per_km2=1",
                                                                "building_density_per_km2=300 bs_density_per_km2=2.5"});
  const Condition& last = experiment.conditions[5];
  CHECK(last.index == 5);
  CHECK(last.parameters == Json{{"building_density_per_km2", 300}, {"bs_density_per_km2", 2.5}});
  CHECK(last.world.number("building_density_per_km2") == 300);
}

TEST_CASE("presets sweep like any value, and change the defaults of their condition alone") {
  const Experiment experiment = parsed(R"("world": {"preset": ["published", "geometric"]})");
  REQUIRE(experiment.conditions.size() == 2);
  CHECK(experiment.conditions[0].world.text("los_ray") == "published");
  CHECK(experiment.conditions[1].world.text("los_ray") == "geometric");
}

TEST_CASE("the default channel model is implied, but can be swept") {
  const Experiment implied = parsed(R"("world": {})");
  CHECK_FALSE(implied.canonical["worlds"][0].contains("propagation"));
  CHECK(parsed(R"("world": {"propagation": "power-law"})").canonical == implied.canonical);
  const Experiment swept = parsed(R"("world": {"propagation": ["power-law"]})");
  CHECK(condition_names(swept) == std::vector<std::string>{"propagation=power-law"});
  CHECK(parse(swept.canonical.dump(), "canonical").canonical == swept.canonical);
}

TEST_CASE("several worlds each have their own sweep; names tell them apart") {
  const Flight flight;
  const Experiment experiment = parse(R"({"name": "test", "trials": 2, "agents": ["min-height"], "worlds": [
      {"name": "ours", "bs_density_per_km2": [1, 2]}, {"bs_density_per_km2": [1, 2]},
      {"kind": "measured", "file": ")" + flight.csv.string() +
                                          R"("}]})",
                                      "test");
  CHECK(condition_names(experiment) == std::vector<std::string>{"ours bs_density_per_km2=1",
                                                                "ours bs_density_per_km2=2", "bs_density_per_km2=1",
                                                                "bs_density_per_km2=2", "measured"});
  CHECK(experiment.conditions[4].kind == WorldKind::measured);
}

TEST_CASE("a measured flight counts by its content, not by its path") {
  const Flight flight;
  const Experiment before = parsed(flight.world());
  CHECK(before.conditions[0].world.text("file_sha256").size() == 64);
  const auto moved = flight.folder / "moved.csv";
  std::filesystem::copy_file(flight.csv, moved);
  CHECK(parsed(R"("world": {"kind": "measured", "file": ")" + moved.string() + R"("})").id == before.id);
  flight.write("step,height_m,throughput_kbps\n1,20,100\n1,30,200\n2,20,300\n2,30,401\n");
  CHECK(parsed(flight.world()).id != before.id);
}

TEST_CASE("a model file counts by its content in the crew of a relay, too") {
  const Flight flight;  // for its folder
  const auto with = [&](const char* name, const std::string& more) {
    std::filesystem::create_directories(flight.folder / name);
    const std::filesystem::path model = flight.folder / name / "model.pb";
    std::filesystem::copy_file(source_dir / "data/models/pretrained.pb", model,
                               std::filesystem::copy_options::overwrite_existing);
    return parse(R"({"name": "x", "trials": 1, "world": {}, "agents": [{"type": "relay", "name": "both", "crew": [
                   {"agent": "min-height"}, {"agent": {"type": "pretrained", "model": ")" +
                     model.string() + R"("}, "from_step": )" + more + "}]}]}",
                 "test");
  };
  const Experiment before = with("here", "5");
  CHECK(before.agents[0].crew[1].agent.parameters.text("model_sha256").size() == 64);
  CHECK(with("there", "5").id == before.id);
  CHECK(with("there", "6").id != before.id);
  nlohmann::json other = before.canonical;
  other["agents"][0]["crew"][1]["agent"]["model_sha256"] = std::string(64, '0');
  CHECK(id_of(other) != before.id);
}

TEST_CASE("a foreign agent's privilege, which came later, keeps the id of older experiments unless it has one") {
  const auto with = [](const std::string& privilege) {
    return parse(R"({"name": "test", "trials": 2, "world": {}, "agents": ["min-height", {"type": "external", )"
                 R"("name": "visitor")" +
                     privilege + "}]}",
                 "test");
  };
  Json without = with("").canonical;
  CHECK(without["agents"][1].erase("privilege") == 1);
  CHECK(id_of(without) == with("").id);
  CHECK(with(R"(, "privilege": "none")").id == with("").id);
  CHECK(with(R"(, "privilege": "next-step")").id != with("").id);
}

TEST_CASE("a measured flight that changed under a resolved experiment is refused, a missing one only when needed") {
  const Flight flight;
  const Experiment before = parsed(flight.world());
  const std::string canonical = before.canonical.dump();
  CHECK(make_signal_map(before, before.conditions[0], 0)->steps() == 2);

  flight.write("step,height_m,throughput_kbps\n1,20,100\n1,30,200\n");
  CHECK(parse(canonical, "wire").id == before.id);  // not read: a report needs no CSV
  CHECK_THROWS_WITH(make_signal_map(before, before.conditions[0], 0),
                    Contains("has changed") && Contains("flight.csv"));
  write_file(flight.folder / "resolved.json", canonical);
  CHECK_THROWS_WITH(load(flight.folder / "resolved.json"), Contains("worlds[0].file") && Contains("SHA-256"));
}

/// The working directory of this process, while the object lives.
class WorkingDirectory {
 public:
  explicit WorkingDirectory(const std::filesystem::path& folder) { std::filesystem::current_path(folder); }
  ~WorkingDirectory() { std::filesystem::current_path(before_); }
  WorkingDirectory(const WorkingDirectory&) = delete;
  WorkingDirectory& operator=(const WorkingDirectory&) = delete;

 private:
  std::filesystem::path before_ = std::filesystem::current_path();
};

TEST_CASE("paths in an experiment file count from its folder, those of overrides from the working directory") {
  const Flight flight;
  const std::filesystem::path model = source_dir / "data/models/pretrained.pb";
  const std::filesystem::path inside = flight.folder / "experiments";
  const std::filesystem::path elsewhere = flight.folder / "elsewhere";
  for (const auto& folder : {inside, elsewhere}) std::filesystem::create_directories(folder);
  for (const auto& folder : {inside, flight.folder / "models"}) {
    std::filesystem::create_directories(folder);
    std::filesystem::copy_file(model, folder / "model.pb");
  }
  std::filesystem::copy_file(flight.csv, elsewhere / "mine.csv");
  write_file(inside / "all.json", R"({"name": "x", "trials": 1,
    "worlds": [{"kind": "measured", "file": ["../flight.csv"]}, {}],
    "agents": [{"type": "pretrained", "model": ["../models/model.pb", "model.pb"]},
               {"type": "relay", "name": "crew", "crew": [{"agent": "min-height"},
                 {"agent": {"type": "pretrained", "model": "model.pb"}, "from_step": 2}]}]})");
  const auto file_of = [](const Experiment& experiment) { return experiment.conditions[0].world.text("file"); };

  std::set<std::string> ids;
  for (const auto& folder : {inside, elsewhere, std::filesystem::path("/")}) {
    const WorkingDirectory here(folder);
    const Experiment experiment = load(std::filesystem::relative(inside / "all.json"));
    ids.insert(experiment.id);
    CHECK(file_of(experiment) == flight.csv.string());
    CHECK(experiment.agents[0].parameters.text("model") == flight.folder / "models/model.pb");
    CHECK(experiment.agents[1].parameters.text("model") == inside / "model.pb");
    CHECK(experiment.agents[2].crew[1].agent.parameters.text("model") == inside / "model.pb");
  }
  CHECK(ids.size() == 1);

  const WorkingDirectory here(elsewhere);
  CHECK(file_of(load("../experiments/all.json", {.set = {"worlds.0.file=mine.csv"}})) == elsewhere / "mine.csv");
  CHECK_THROWS_WITH(load("../experiments/all.json", {.set = {"worlds.0.file=flight.csv"}}),
                    Contains("worlds[0].file") && Contains((elsewhere / "flight.csv").string()) &&
                        Contains("count from that file's folder"));
  // A path in the file is never searched for in another folder.
  write_file(inside / "wrong.json", R"({"name": "x", "trials": 1, "agents": ["min-height"],
    "world": {"kind": "measured", "file": "mine.csv"}})");
  CHECK_THROWS_WITH(load("../experiments/wrong.json"), Contains((inside / "mine.csv").string()));
}

TEST_CASE("seeds use all 64 bits") {
  const Experiment experiment = parsed(R"("world": {})", R"("seed": 18446744073709551615, )");
  CHECK(experiment.seed == 18446744073709551615U);
  const Experiment again = parse(experiment.canonical.dump(), "canonical");
  CHECK(again.seed == 18446744073709551615U);
  CHECK(again.id == experiment.id);
  CHECK(experiment.id != parsed(R"("world": {})", R"("seed": 18446744073709551614, )").id);
}

TEST_CASE("ids ignore what cannot change a result, and nothing else") {
  const std::string base = parsed(R"("world": {})").id;
  CHECK(base.size() == 16);
  CHECK(
      parsed(R"("world": {"bs_density_per_km2": 2.5})", R"("seed": 1, "description": "a default, spelled out", )").id ==
      base);
  CHECK(parsed(R"("worlds": [{"name": "called otherwise"}])").id == base);
  CHECK(parsed(R"("world": {"serving": "strongest"})").id == base);
  CHECK(parsed(R"("world": {"serving": "a3", "a3_offset_db": 2})").id == parsed(R"("world": {"serving": "a3"})").id);
  const std::set<std::string> different{base,
                                        parsed(R"("world": {})", R"("seed": 2, )").id,
                                        parsed(R"("world": {})", R"("max_attempts": 4, )").id,
                                        parsed(R"("world": {"bs_density_per_km2": 2.6})").id,
                                        parsed(R"("world": {})", R"("energy_weight": 0.1, )").id,
                                        parsed(R"("world": {})", R"("handover_cost": 2, )").id,
                                        parsed(R"("world": {})", R"("speed_m_per_s": 15, )").id,
                                        parsed(R"("world": {})", R"("handover_loss": 0.5, )").id,
                                        parsed(R"("world": {})", R"("outage_threshold_db": -8, )").id,
                                        parsed(R"("world": {"serving": "a3"})").id,
                                        parsed(R"("world": {"serving": "a3", "l3_filter_k": 4})").id,
                                        parsed(R"("world": {})", "", {.trials = 3}).id,
                                        parsed(R"("world": {})", "", {.agents = {"min-height"}}).id,
                                        parsed(R"("world": {})", "", {.agents = {"constant-120", "min-height"}}).id};
  CHECK(different.size() == 14);

  // Results that were stored before costs existed keep their id.
  nlohmann::json before = parsed(R"("world": {})").canonical;
  for (const char* key : {"energy_weight", "handover_cost", "speed_m_per_s", "handover_loss", "outage_threshold_db"})
    REQUIRE(before.erase(key) == 1);
  CHECK(id_of(before) == parsed(R"("world": {})").id);
}

TEST_CASE("the differences between two experiments are given in words") {
  const Experiment a = parsed(R"("world": {"bs_density_per_km2": [1, 2]})");
  const auto told = [&](const Experiment& b) { return describe_differences(a.canonical, b.canonical); };
  CHECK(told(a).empty());
  CHECK(told(parsed(R"("world": {"bs_density_per_km2": [1, 3]})")) ==
        "worlds[1].bs_density_per_km2 is 2 there and 3 here");
  CHECK(told(parsed(R"("world": {"bs_density_per_km2": [1, 2]})", R"("seed": 9, )")) == "seed is 1 there and 9 here");
  CHECK(told(parsed(R"("world": {})")) == "there are 2 conditions there and 1 here");
  CHECK(told(parsed(R"("world": {"bs_density_per_km2": [1, 2]})", "", {.agents = {"planner", "dqn"}, .trials = 7})) ==
        "the agents are min-height, constant-120 there and planner, dqn here; trials is 2 there and 7 here");
  CHECK(told(parsed(R"("world": {"bs_density_per_km2": [1, 2]})", R"("energy_weight": 0.5, )")) ==
        "energy_weight is 0.5 here and not set there");
  CHECK_THAT(told(parsed(R"("world": {"preset": "geometric", "bs_density_per_km2": [1, 2]})", R"("seed": 4, )")),
             Catch::StartsWith("seed is 1 there and 4 here; worlds[0].") && Contains("; and "));
}

TEST_CASE("overrides: --set by path, --trials, --seed, --agents") {
  Overrides overrides;
  overrides.set = {"world.bs_density_per_km2=[1,5]", "world.los_ray=geometric", "trials=7", "description=two words"};
  overrides.seed = 18446744073709551615U;
  const Experiment experiment = parsed(R"("world": {"building_density_per_km2": 100})", "", overrides);
  CHECK(experiment.trials == 7);
  CHECK(experiment.seed == 18446744073709551615U);
  CHECK(experiment.description == "two words");
  CHECK(experiment.conditions.size() == 2);
  CHECK(experiment.conditions[1].world.text("los_ray") == "geometric");
  overrides.trials = 8;
  CHECK(parsed(R"("world": {})", "", overrides).trials == 8);
}

TEST_CASE("--set reaches into lists, and turns a named agent into one with parameters") {
  const Experiment experiment =
      parse(R"({"name": "x", "trials": 1, "worlds": [{"name": "a"}, {"name": "b"}], "agents": ["min-height", "dqn"]})",
            "x", {.set = {"worlds.1.bs_density_per_km2=4", "agents.1.discount=0.5"}});
  CHECK(experiment.conditions[0].world.number("bs_density_per_km2") == 2.5);
  CHECK(experiment.conditions[1].world.number("bs_density_per_km2") == 4);
  CHECK(experiment.agent("dqn").parameters.number("discount") == 0.5);
}

TEST_CASE("--agents takes the file's own agents by name, and any other of the registry") {
  const std::string file =
      R"({"name": "x", "trials": 1, "world": {}, "agents": ["min-height", {"type": "dqn", "name": "mine", "discount": 0.5}]})";
  const Experiment experiment = parse(file, "x", {.agents = {"constant-60", "mine"}});
  CHECK(agent_names(experiment) == std::vector<std::string>{"constant-60", "mine"});
  CHECK(experiment.agent("mine").parameters.number("discount") == 0.5);
  CHECK(experiment.agent("constant-60").parameters.number("height_m") == 60);
}

TEST_CASE("a resolved experiment resolves to itself") {
  const Flight flight;
  const bool holds = rc::check([&] {
    const auto densities = *rc::gen::unique<std::vector<int>>(3, rc::gen::inRange(1, 50));
    const auto seed = *rc::gen::arbitrary<std::uint64_t>();
    const bool list = *rc::gen::arbitrary<bool>();
    const auto preset = *rc::gen::element<std::string>("published", "paper-text", "geometric");
    Json file{{"name", "round-trip"},
              {"description", *rc::gen::element<std::string>("", "über \"all\"")},
              {"seed", seed},
              {"trials", *rc::gen::inRange(1, 2'500'000)},
              {"max_attempts", *rc::gen::inRange(1, 10)},
              {"worlds",
               {{{"preset", preset}, {"bs_density_per_km2", list ? Json(densities) : Json(densities[0] + 0.1)}},
                {{"kind", "measured"}, {"file", flight.csv.string()}}}},
              {"agents", {"min-height", {{"type", "dqn"}, {"loss", {"mse", "cross-entropy"}}}, "constant-120"}}};
    const Experiment once = parse(file.dump(), "file");
    const Experiment twice = parse(once.canonical.dump(), "canonical");
    RC_ASSERT(twice.canonical == once.canonical);
    RC_ASSERT(twice.id == once.id);
    RC_ASSERT(twice.conditions.size() == (list ? 4U : 2U));
    for (std::size_t i = 0; i < once.conditions.size(); ++i) {
      RC_ASSERT(twice.conditions[i].name == once.conditions[i].name);
      RC_ASSERT(twice.conditions[i].parameters == once.conditions[i].parameters);
      RC_ASSERT(twice.conditions[i].world.to_json() == once.conditions[i].world.to_json());
    }
  });
  CHECK(holds);
}

TEST_CASE("episode ids differ for every flight and experiment") {
  const Experiment a = parsed(R"("world": {})");
  const Experiment b = parsed(R"("world": {})", R"("seed": 2, )");
  const std::set<std::uint64_t> ids{episode_id(a, {0, 0, "min-height"}), episode_id(a, {0, 1, "min-height"}),
                                    episode_id(a, {1, 0, "min-height"}), episode_id(a, {0, 0, "dqn"}),
                                    episode_id(b, {0, 0, "min-height"})};
  CHECK(ids.size() == 5);
  CHECK(episode_id(a, {0, 0, "dqn"}) == episode_id(parsed(R"("world": {})"), {0, 0, "dqn"}));
}

TEST_CASE("the shipped experiments have the documented conditions, trials and agents") {
  const auto shipped = [](const char* name) { return load(source_dir / "data/experiments" / name); };
  CHECK(condition_names(shipped("bs-density.json")) ==
        std::vector<std::string>{"bs_density_per_km2=1", "bs_density_per_km2=2.5", "bs_density_per_km2=5"});
  CHECK(shipped("building-density.json").conditions[2].world.number("building_density_per_km2") == 300);
  CHECK(shipped("bs-density.json").trials == 100);
  CHECK(shipped("measured.json").conditions.size() == 1);
  const Experiment quick = shipped("quick.json");
  CHECK(quick.agents.size() == 10);
  CHECK(quick.conditions.back().kind == WorldKind::measured);
}

TEST_CASE("conditions of a sweep share the parts of a city that the sweep does not change") {
  const Experiment experiment = parsed(R"("world": {"building_density_per_km2": [100, 300]})");
  const world::City few = make_city(experiment, experiment.conditions[0], 1);
  const world::City many = make_city(experiment, experiment.conditions[1], 1);
  REQUIRE(few.base_stations.size() == many.base_stations.size());
  CHECK(few.base_stations[0].x_m == many.base_stations[0].x_m);
  CHECK(few.building_height_m.size() < many.building_height_m.size());
}

TEST_CASE("trials depend on earlier trials only if an agent remembers those") {
  const auto lineages = [](const std::string& agents) {
    return trial_lineages(parse(R"({"name": "t", "trials": 9, "world": {}, "agents": [)" + agents + "]}", "test"));
  };
  const std::string six = R"({"type": "dqn", "name": "six", "memory": "lifelong", "lineages": 6})";
  const std::string four = R"({"type": "dqn", "name": "four", "memory": "lifelong", "lineages": 4})";
  CHECK(lineages(R"("min-height", "dqn")") == 0);
  CHECK(lineages(R"("min-height", )" + six) == 6);
  CHECK(lineages(six + ", " + four) == 2);
}
