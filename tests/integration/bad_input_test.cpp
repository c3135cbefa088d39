// Every kind of wrong input: exit code 2, a message that names what, where and what to do, and nothing written.
#include <catch2/catch.hpp>

#include "tests/integration/command.hpp"
#include "tests/paths.hpp"

using aloft::test::Finished;
using aloft::test::run_command;
using aloft::test::ScratchDir;
using aloft::test::write_text;
using Catch::Contains;

namespace {

const std::string small_experiment = R"({
  "name": "small",
  "seed": 3,
  "trials": 2,
  "world": {"kind": "generated", "bs_density_per_km2": [2.5, 5], "building_density_per_km2": 200},
  "agents": ["min-height", "random-walk"]
})";

/// Runs `text` as an experiment with further options; nothing may be written.
Finished refused(const std::string& text, const std::vector<std::string>& options = {}) {
  const ScratchDir scratch;
  write_text(scratch / "experiment.json", text);
  std::vector<std::string> arguments{"aloft",        "run",   (scratch / "experiment.json").string(),
                                     "--in-process", "--out", (scratch / "out").string()};
  arguments.insert(arguments.end(), options.begin(), options.end());
  Finished finished = run_command(arguments);
  CHECK(finished.exit_code == 2);
  CHECK(finished.out.empty());
  CHECK_FALSE(std::filesystem::exists(scratch / "out"));
  return finished;
}

std::string with(const std::string& from, const std::string& to) {
  std::string text = small_experiment;
  const auto at = text.find(from);
  REQUIRE(at != std::string::npos);
  return text.replace(at, from.size(), to);
}

}  // namespace

TEST_CASE("malformed JSON is refused with line and column") {
  const Finished finished = refused("{\n  \"name\": \"x\",\n  \"trials\": 2,,\n}");
  CHECK_THAT(finished.err, Contains("experiment.json") && Contains("line 3") && Contains("column"));
}

TEST_CASE("JSON nested too deep is refused with the place and the limit, wherever it comes in") {
  const std::string deep(200'000, '[');
  const std::string limit = "nested more than 32 deep";
  CHECK_THAT(refused(with("\"random-walk\"", "\n" + deep)).err,
             Contains("experiment.json: line 7, column 31: ") && Contains(limit));
  CHECK_THAT(refused(with("200", deep + std::string(deep.size(), ']'))).err, Contains(limit));
  const std::string shallow = std::string(100, '[') + std::string(100, ']');
  CHECK_THAT(refused(small_experiment, {"--set", "world.steps=" + shallow}).err, Contains("--set") && Contains(limit));
  const ScratchDir scratch;
  write_text(scratch / "deep.json", deep);
  const std::string file = (scratch / "deep.json").string();
  const std::vector<std::vector<std::string>> commands{
      {"aloft", "validate", file},
      {"aloft-coordinator", "--experiment", file, "--results", (scratch / "out").string()},
      {"aloft", "train", "pretrained", "--config", file, "--out", (scratch / "model").string()}};
  for (const std::vector<std::string>& command : commands) {
    const Finished finished = run_command(command);
    INFO(command.front() << " " << command[1] << ": " << finished.err);
    CHECK(finished.exit_code == 2);
    CHECK_THAT(finished.err, Contains("deep.json: line 1, column 33: ") && Contains(limit));
    CHECK(finished.err.size() < 500);
  }
}

TEST_CASE("an unknown key is refused with the nearest valid one") {
  CHECK_THAT(refused(with("\"trials\"", "\"trails\"")).err, Contains("trails") && Contains("trials"));
  CHECK_THAT(refused(with("\"bs_density_per_km2\"", "\"bs_densty_per_km2\"")).err,
             Contains("world.bs_densty_per_km2") && Contains("Did you mean 'bs_density_per_km2'?"));
  CHECK_THAT(refused(small_experiment, {"--set", "world.bilding_density_per_km2=1"}).err,
             Contains("building_density_per_km2"));
}

TEST_CASE("a wrong type or range is refused with JSON path and allowed range") {
  CHECK_THAT(refused(with("\"trials\": 2", "\"trials\": 0")).err, Contains("trials") && Contains("1"));
  CHECK_THAT(refused(with("\"trials\": 2", "\"trials\": 2, \"energy_weight\": -1")).err,
             Contains("energy_weight") && Contains("10000"));
  CHECK_THAT(refused(with("\"trials\": 2", "\"trials\": \"two\"")).err, Contains("trials") && Contains("two"));
  CHECK_THAT(refused(with("[2.5, 5]", "-1")).err, Contains("world.bs_density_per_km2") && Contains("-1"));
  CHECK_THAT(refused(with("[2.5, 5]", "[2.5, \"x\"]")).err, Contains("world.bs_density_per_km2"));
  CHECK_THAT(refused(with("\"random-walk\"", R"({"type": "constant", "height_m": "high"})")).err,
             Contains("agents[1].height_m"));
  CHECK_THAT(refused(small_experiment, {"--seed", "-1"}).err, Contains("seed"));
}

TEST_CASE("an unknown agent is refused with the nearest valid one") {
  CHECK_THAT(refused(with("random-walk", "random-wlk")).err, Contains("random-wlk") && Contains("random-walk"));
  CHECK_THAT(refused(small_experiment, {"--agents", "min-hight"}).err, Contains("min-height"));
}

TEST_CASE("a model file that is missing, damaged or cut off is refused with its name and the reason") {
  const ScratchDir scratch;
  const std::string model = (scratch / "mine.pb").string();
  const std::string text = with("\"random-walk\"", R"({"type": "pretrained", "model": ")" + model + "\"}");
  CHECK_THAT(refused(text).err, Contains(model));
  write_text(model, "these are no weights");
  CHECK_THAT(refused(text).err, Contains(model) && Contains("not a model file"));
  const std::string whole = aloft::test::read_text(aloft::test::source_dir() / "data/models/pretrained.pb");
  write_text(model, whole.substr(0, whole.size() / 2));
  CHECK_THAT(refused(text).err, Contains(model) && Contains("truncated"));
}

TEST_CASE("an empty sweep and doubled agents are refused") {
  CHECK_THAT(refused(with("[2.5, 5]", "[]")).err, Contains("world.bs_density_per_km2") && Contains("empty"));
  CHECK_THAT(refused(with("\"random-walk\"", "\"min-height\"")).err, Contains("min-height"));
}

TEST_CASE("an unreadable or ill-formed CSV is refused with line, column and reason") {
  const ScratchDir scratch;
  const std::string csv = (scratch / "flight.csv").string();
  const std::string measured = R"({"name": "m", "trials": 1, "world": {"kind": "measured", "file": ")" + csv +
                               R"("}, "agents": ["min-height"]})";
  CHECK_THAT(refused(measured).err, Contains(csv));
  write_text(csv, "step,height_m,throughput_kbps\n1,20,100\n1,30,1oo\n");
  CHECK_THAT(refused(measured).err, Contains(csv) && Contains("3") && Contains("1oo"));
  write_text(csv, "step,height_m,throughput_kbps\n1,20,100\n1,30,100\n2,20,100\n");
  CHECK_THAT(refused(measured).err, Contains(csv));
  write_text(csv, "step,height,throughput_kbps\n");
  CHECK_THAT(refused(measured).err, Contains("height_m"));
}

TEST_CASE("an agent with the site map over a measured flight without base stations is refused before anything flies") {
  const ScratchDir scratch;
  const std::string csv = (scratch / "flight.csv").string();
  write_text(csv, "step,height_m,throughput_kbps\n1,20,100\n1,30,100\n");
  const std::string measured = R"({"name": "m", "trials": 1, "world": {"kind": "measured", "file": ")" + csv +
                               R"("}, "agents": ["min-height", "site-planner"]})";
  const std::string sites = (scratch / "sites.csv").string();
  CHECK_THAT(refused(measured).err, Contains((scratch / "flight.sites.csv").string() + " or " + sites) &&
                                        Contains("is missing; add it") && Contains("leave 'site-planner' out"));
  write_text(sites, "cell,latitude,longitude,antenna_height_m\n1,53,-6,3O\n");
  CHECK_THAT(refused(measured).err, Contains("latitude and longitude"));
  write_text(csv, "step,height_m,throughput_kbps,latitude,longitude\n1,20,100,53,-6\n1,30,100,53,-6\n");
  CHECK_THAT(refused(measured).err, Contains(sites + ":2:9: antenna_height_m is '3O'"));
}

TEST_CASE("an experiment file that is not there is refused") {
  const Finished finished = run_command({"aloft", "run", "no-such-file.json"});
  CHECK(finished.exit_code == 2);
  CHECK_THAT(finished.err, Contains("no-such-file.json"));
  const Finished misspelt = run_command({"aloft", "validate", "quik"});
  CHECK(misspelt.exit_code == 2);
  CHECK_THAT(misspelt.err, Contains("'quik' is no file here") && Contains("Did you mean 'quick'?") &&
                               Contains("bs-density, building-density"));
}

TEST_CASE("a wrong flag or command is refused with the nearest valid one") {
  const Finished flag = run_command({"aloft", "run", "data/experiments/quick.json", "--wrkers", "2"});
  CHECK(flag.exit_code == 2);
  CHECK_THAT(flag.err, Contains("--wrkers") && Contains("--workers"));
  const Finished threads = run_command({"aloft", "worker", "--join", "x", "--learner-threads", "0"});
  CHECK(threads.exit_code == 2);
  CHECK_THAT(threads.err, Contains("--learner-threads") && Contains("256"));
  const Finished command = run_command({"aloft", "validat"});
  CHECK(command.exit_code == 2);
  CHECK_THAT(command.err, Contains("validate"));
  CHECK(run_command({"aloft"}).exit_code == 2);
}

TEST_CASE("an unwritable result folder is refused") {
  const ScratchDir scratch;
  write_text(scratch / "experiment.json", small_experiment);
  write_text(scratch / "file", "");
  const Finished finished = run_command({"aloft", "run", (scratch / "experiment.json").string(), "--in-process",
                                         "--out", (scratch / "file" / "below").string()});
  CHECK(finished.exit_code == 2);
  CHECK_THAT(finished.err, Contains("below"));
}

TEST_CASE("results of another experiment are refused and left alone") {
  const ScratchDir scratch;
  const std::string experiment = (scratch / "experiment.json").string();
  const std::string out = (scratch / "out").string();
  write_text(experiment, small_experiment);
  REQUIRE(run_command({"aloft", "run", experiment, "--in-process", "--out", out}).exit_code == 0);
  const std::string digest = run_command({"aloft", "digest", out}).out;
  const Finished other = run_command({"aloft", "run", experiment, "--in-process", "--out", out, "--seed", "4"});
  CHECK(other.exit_code == 2);
  CHECK_THAT(other.err, Contains("holds the results of another experiment: seed is 3 there and 4 here. Name another "
                                 "folder with --out"));
  CHECK(run_command({"aloft", "digest", out}).out == digest);
}

TEST_CASE("a folder that is no result folder is refused") {
  const ScratchDir scratch;
  for (const std::vector<std::string>& command :
       {std::vector<std::string>{"digest"}, std::vector<std::string>{"export", "--flights"}}) {
    std::vector<std::string> arguments{"aloft"};
    arguments.insert(arguments.end(), command.begin(), command.end());
    arguments.push_back(scratch.path().string());
    const Finished finished = run_command(arguments);
    CHECK(finished.exit_code == 2);
    CHECK_THAT(finished.err, Contains(scratch.path().string()));
  }
}
