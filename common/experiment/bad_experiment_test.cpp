// Every kind of wrong experiment file: the message says what is wrong, where, what is allowed and what to do.
#include <unistd.h>

#include <catch2/catch.hpp>
#include <filesystem>

#include "common/base/error.hpp"
#include "common/base/write_file.hpp"
#include "common/experiment/experiment.hpp"

using namespace aloft;
using namespace aloft::experiment;
using Catch::Contains;

namespace {

std::string message(const std::string& text, const Overrides& overrides = {}) {
  try {
    (void)parse(text, "my.json", overrides);
  } catch (const InputError& error) {
    return error.what();
  }
  FAIL("accepted: " << text);
  return {};
}

const std::string good =
    R"({"name": "x", "trials": 2, "world": {"bs_density_per_km2": [1, 5]}, "agents": ["min-height", "random-walk"]})";

std::string with(const std::string& from, const std::string& to) {
  std::string text = good;
  const auto at = text.find(from);
  REQUIRE(at != std::string::npos);
  return text.replace(at, from.size(), to);
}

std::string measured(const std::filesystem::path& file) {
  return with(R"("bs_density_per_km2": [1, 5])", R"("kind": "measured", "file": ")" + file.string() + "\"");
}

}  // namespace

TEST_CASE("the experiment that these tests spoil is accepted") {
  CHECK(parse(good, "my.json").conditions.size() == 2);
}

TEST_CASE("malformed JSON: file, line, column") {
  CHECK_THAT(message("{\n  \"name\": \"x\",\n  \"trials\": 2,,\n}"),
             Contains("my.json: line 3, column 15: not valid JSON"));
  CHECK_THAT(message(""), Contains("my.json: line 1, column 1: not valid JSON"));
  CHECK_THAT(message("{\"name\": \"x\""), Contains("line 1, column 13") && Contains("unexpected end of input"));
  CHECK_THAT(message(with("2,", "1e999,")), Contains("my.json") && Contains("1e999"));
  CHECK_THAT(message(with("\"trials\": 2", "\"trials\": 2, \"trials\": 3")), Contains("\"trials\" stands twice"));
  CHECK_THAT(message("[1, 2]"), Contains("my.json: [1,2] is not an experiment"));
}

TEST_CASE("unknown keys: the nearest valid one") {
  CHECK_THAT(message(with("\"trials\"", "\"trails\"")),
             Contains("my.json: trails: unknown key. Did you mean 'trials'?"));
  CHECK_THAT(message(with("bs_density_per_km2", "bs_densty_per_km2")),
             Contains("world.bs_densty_per_km2: unknown key. Did you mean 'bs_density_per_km2'?"));
  CHECK_THAT(message(with("\"random-walk\"", R"({"type": "dqn", "discont": 1})")),
             Contains("agents[1].discont: unknown key. Did you mean 'discount'?"));
  CHECK_THAT(message(with("\"bs_density_per_km2\": [1, 5]", "\"file\": \"a.csv\"")),
             Contains("add \"kind\": \"measured\""));
}

TEST_CASE("handover: its parameters alone, out of range, contradictory") {
  const auto world = [](const std::string& more) { return message(with("[1, 5]", "1, " + more)); };
  CHECK_THAT(world(R"("a3_offset_db": 3)"),
             Contains("world.a3_offset_db: only worlds with serving \"a3\" have handovers"));
  CHECK_THAT(world(R"("serving": ["a3", "strongest"], "l3_filter_k": 4)"), Contains("world.l3_filter_k: only worlds"));
  CHECK_THAT(world(R"("serving": "a5")"), Contains("world.serving: \"a5\"") && Contains("\"strongest\", \"a3\""));
  CHECK_THAT(world(R"("serving": "a3", "time_to_trigger_s": 6)"),
             Contains("world.time_to_trigger_s: 6 is not allowed; use a number from 0 to 5.12"));
  CHECK_THAT(world(R"("serving": "a3", "l3_filter_k": 1.5)"),
             Contains("world.l3_filter_k: 1.5 is not allowed; use a whole number from 0 to 19"));
  CHECK_THAT(world(R"("serving": "a3", "qin_db": -9)"),
             Contains("world.qin_db: -9 is below qout_db -8; use at least that"));
  CHECK_THAT(message(with("2,", "2, \"handover_loss\": 1.5,")),
             Contains("handover_loss: 1.5 is not allowed; use a number from 0 to 1"));
  CHECK_THAT(message(with("2,", "2, \"outage_threshold_db\": \"low\",")), Contains("outage_threshold_db: \"low\""));
  CHECK_THAT(message(with("\"bs_density_per_km2\": [1, 5]", R"("kind": "measured", "file": "x.csv", "serving": "a3")")),
             Contains("world.serving: unknown key"));
}

TEST_CASE("missing keys are named") {
  CHECK_THAT(message(with("\"trials\": 2,", "")), Contains("\"trials\" is missing"));
  CHECK_THAT(message(R"({"name": "x", "trials": 1, "agents": ["min-height"]})"), Contains("\"world\" is missing"));
  CHECK_THAT(message(with("\"agents\"", "\"worlds\": [{}], \"agents\"")), Contains("cannot stand together"));
  CHECK_THAT(message(with("\"bs_density_per_km2\": [1, 5]", "\"kind\": \"measured\"")),
             Contains("world.file: missing"));
}

TEST_CASE("wrong type or range: JSON path, value, what is allowed") {
  CHECK_THAT(message(with("2,", "0,")), Contains("trials: 0 is not allowed; use a whole number from 1 to 10000000"));
  CHECK_THAT(message(with("2,", "10000001,")), Contains("10000001"));
  CHECK_THAT(message(with("2,", "\"two\",")), Contains("trials: \"two\" is not allowed"));
  CHECK_THAT(message(with("[1, 5]", "-1")), Contains("world.bs_density_per_km2: -1 is not allowed; use a number from"));
  CHECK_THAT(message(with("[1, 5]", "[1, \"x\"]")), Contains("world.bs_density_per_km2: \"x\" is not allowed"));
  CHECK_THAT(message(with("[1, 5]", "[1, [5]]")), Contains("world.bs_density_per_km2: [5] is not allowed"));
  CHECK_THAT(message(with("\"world\": {", "\"world\": {\"kind\": \"mesured\", ")),
             Contains("world.kind: \"mesured\"") && Contains("\"measured\""));
  CHECK_THAT(message(with("\"world\": {", "\"world\": {\"name\": \"\", ")), Contains("world.name"));
  CHECK_THAT(message(with("\"world\": {\"bs_density_per_km2\": [1, 5]}", "\"worlds\": [{}, 3]")),
             Contains("worlds[1]: 3 is not allowed"));
  CHECK_THAT(message(with("\"world\": {\"bs_density_per_km2\": [1, 5]}", "\"worlds\": []")),
             Contains("worlds: [] is not allowed"));
  CHECK_THAT(message(with("\"name\": \"x\"", "\"name\": \"../x\"")), Contains("name: \"../x\" is not allowed"));
  CHECK_THAT(message(with("\"name\": \"x\"", "\"name\": 3")), Contains("name: 3 is not allowed; use a text"));
  CHECK_THAT(message(with("2,", "2, \"on_agent_loss\": \"retry\",")),
             Contains("on_agent_loss") && Contains("\"restart\", \"failover\""));
  for (const char* seed : {"-1", "1.5", "\"1\"", "18446744073709551616"})
    CHECK_THAT(message(with("2,", std::string("2, \"seed\": ") + seed + ",")),
               Contains("seed: ") && Contains("18446744073709551615"));
}

TEST_CASE("agents: unknown, doubled, none, too many, contradictory") {
  CHECK_THAT(message(with("random-walk", "random-wlk")),
             Contains("agents[1]: unknown agent 'random-wlk'. Did you mean 'random-walk'?"));
  CHECK_THAT(message(with("random-walk", "min-height")),
             Contains("agents[1]") && Contains("\"min-height\" stands already at agents[0]"));
  CHECK_THAT(message(with("\"random-walk\"", R"({"type": "height-filter", "se_change_sd": [0.0, -0.0]})")),
             Contains("agents[1]") && Contains("\"height-filter-0\" stands already at agents[1]"));
  CHECK_THAT(message(with("[\"min-height\", \"random-walk\"]", "[]")), Contains("agents: [] is not allowed"));
  CHECK_THAT(message(with("[\"min-height\", \"random-walk\"]", "\"dqn\"")),
             Contains("agents: \"dqn\" is not allowed; use a list"));
  CHECK_THAT(message(with("\"random-walk\"", R"({"type": "constant", "height_m": "high"})")),
             Contains("agents[1].height_m: \"high\""));
  CHECK_THAT(message(with("\"random-walk\"", R"({"type": "dqn", "replay_capacity": 8, "minibatch": 16})")),
             Contains("replay_capacity"));
  std::string many = "[";
  for (int i = 0; i < 65; ++i) many += (i == 0 ? "\"constant-" : ", \"constant-") + std::to_string(i + 40) + "\"";
  CHECK_THAT(message(with("[\"min-height\", \"random-walk\"]", many + "]")),
             Contains("65 are too many; use at most 64"));
}

TEST_CASE("sweeps and trials that are too many are counted, not expanded") {
  const auto list = [](int values) {
    std::string text = "[0";
    for (int i = 1; i < values; ++i) text += "," + std::to_string(i);
    return text + "]";
  };
  const auto dqn = [&](int epochs, int units) {
    return message(with("\"random-walk\"", R"({"type": "dqn", "epochs": )" + list(epochs) + R"(, "hidden_width": )" +
                                               list(units) + R"(, "minibatch": )" + list(100'000) + "}"));
  };
  CHECK_THAT(dqn(1'000, 10),
             Contains("agents[1]: its lists make 1000000000 combinations") && Contains("at most 64 agents"));
  CHECK_THAT(dqn(3, 10), Contains("3000000 combinations"));
  CHECK_THAT(message(with("[1, 5]", list(200'000))),
             Contains("world.bs_density_per_km2: the list has 200000 values") && Contains("at most 10000 conditions"));
  CHECK_THAT(message(with("[1, 5]", list(10'000))), Contains("world.bs_density_per_km2: 0 is not allowed"));
  CHECK_THAT(message(with("2,", "5000001,")), Contains("2 conditions x 5000001 trials = 10000002 trials"));
  CHECK_NOTHROW(parse(with("2,", "5000000,"), "my.json"));
  CHECK_THAT(message(with("[1, 5]", "1, \"name\": \"x\", \"swept\": " + list(100'000))), Contains("world.swept"));
}

TEST_CASE("a planner on a route that depends on the flight") {
  std::string text = with("random-walk", "planner");
  text.replace(text.find("\"bs_density"), 0, "\"route\": [\"nearest\", \"serving\"], ");
  CHECK_THAT(message(text), Contains("agent 'planner'") && Contains("route=serving bs_density_per_km2=1"));
}

TEST_CASE("an agent that looks at more neighbour cells than the UAV reports") {
  std::string text = with("random-walk", "dqn");
  text.replace(text.find("\"bs_density"), 0, "\"neighbours\": [5, 3], ");
  CHECK_THAT(message(text), Contains("agent 'dqn' looks at 4 neighbour cells") &&
                                Contains("condition \"neighbours=3 bs_density_per_km2=1\"") && Contains("report 3"));
}

TEST_CASE("sweeps: empty, doubled values, too many conditions, equal names") {
  CHECK_THAT(message(with("[1, 5]", "[]")), Contains("world.bs_density_per_km2: the list is empty"));
  CHECK_THAT(message(with("[1, 5]", "[1, 5, 1.0]")), Contains("world.bs_density_per_km2: 1.0 stands twice"));
  std::string hundred = "[1";
  for (int i = 1; i < 100; ++i) hundred += ", " + std::to_string(1 + i * 0.25);
  hundred += "]";
  CHECK_THAT(message(with("[1, 5]", hundred + ", \"building_density_per_km2\": " + hundred +
                                        ", \"los_ray\": [\"published\", \"geometric\"]")),
             Contains("world: the sweep has more than 10000 conditions"));
  CHECK_THAT(message(with("[1, 5]", hundred + ", \"building_density_per_km2\": " + hundred)),
             Contains("10000 conditions") && Contains("at most 1048576 are allowed"));
  CHECK_THAT(
      message(with("\"world\": {\"bs_density_per_km2\": [1, 5]}", "\"worlds\": [{}, {\"bs_density_per_km2\": 5}]")),
      Contains("conditions 0 and 1 are both named \"generated\"") && Contains("\"name\""));
  CHECK_THAT(message(with("[1, 5]", "1, \"swept\": [\"bs_density_per_km2\"]")), Contains("world.swept"));
}

TEST_CASE("measured flights: unreadable or ill-formed files") {
  const auto folder =
      std::filesystem::temp_directory_path() / ("aloft-bad-experiment-test-" + std::to_string(::getpid()));
  std::filesystem::create_directories(folder);
  const auto csv = folder / "flight.csv";
  CHECK_THAT(message(measured(csv)), Contains("my.json: world.file: cannot read '" + csv.string() + "': No such file"));
  CHECK_THAT(message(measured(folder)), Contains("world.file") && Contains("is a folder"));
  write_file(csv, "step,height_m,throughput_kbps\n1,20,100\n1,30,1oo\n");
  CHECK_THAT(message(measured(csv)), Contains(csv.string() + ":3:6: ") && Contains("1oo"));
  write_file(csv, "step,height,throughput_kbps\n1,20,100\n");
  CHECK_THAT(message(measured(csv)), Contains("height_m"));
  std::filesystem::remove_all(folder);
}

TEST_CASE("overrides: wrong paths and values") {
  CHECK_THAT(message(good, {.set = {"world.bilding_density_per_km2=1"}}),
             Contains("Did you mean 'building_density_per_km2'?"));
  CHECK_THAT(message(good, {.set = {"wrld.bs_density_per_km2=1"}}),
             Contains("--set wrld.") && Contains("Did you mean 'world'?"));
  CHECK_THAT(message(good, {.set = {"worlds.0.file=x.csv"}}), Contains("Did you mean 'world'?"));
  CHECK_THAT(message(good, {.set = {"agents.2=dqn"}}), Contains("'agents' has no entry '2'; use a number from 0 to 1"));
  CHECK_THAT(message(good, {.set = {"trials.x=1"}}), Contains("'trials' is 2"));
  CHECK_THAT(message(good, {.set = {"trials"}}), Contains("--set trials: use json.path=value"));
  CHECK_THAT(message(good, {.set = {"trials=zero"}}), Contains("trials: \"zero\" is not allowed"));
  CHECK_THAT(message(good, {.set = {"world.bs_density_per_km2=[]"}}), Contains("empty"));
  CHECK_THAT(message(good, {.set = {"description=\xff"}}), Contains("not UTF-8"));
  CHECK_THAT(message(good, {.agents = {"min-hight"}}),
             Contains("--agents: unknown agent 'min-hight'. Did you mean 'min-height'?"));
  CHECK_THAT(message(good, {.agents = {"dqn", "dqn"}}), Contains("--agents: 'dqn' stands twice"));
  CHECK_THAT(message(good, {.trials = 0}), Contains("trials: 0 is not allowed"));
}

TEST_CASE("an experiment file that cannot be read is named") {
  CHECK_THROWS_WITH(load("no-such-file.json"), Contains("cannot read 'no-such-file.json': No such file"));
}
