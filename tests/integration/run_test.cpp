// aloft run, as a user sees it: the same bytes with any number of workers, order or interruption, and nothing left
// behind.
#include <signal.h>

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>
#include <set>
#include <thread>

#include "common/base/cores.hpp"
#include "tests/integration/command.hpp"
#include "tests/paths.hpp"

using aloft::usable_cores;
using aloft::test::Command;
using aloft::test::Finished;
using aloft::test::read_text;
using aloft::test::run_command;
using aloft::test::ScratchDir;
using aloft::test::test_domain;
using aloft::test::write_text;
using Catch::Contains;
using Json = nlohmann::json;

namespace {

const std::string experiment_text = R"({
  "name": "mixed",
  "seed": 11,
  "trials": 3,
  "worlds": [
    {"kind": "generated", "bs_density_per_km2": [1, 5], "building_density_per_km2": 200, "steps": 30},
    {"kind": "measured", "file": ")" +
                                    aloft::test::source_dir().string() +
                                    R"(/data/samples/measured_sample.csv"}
  ],
  "agents": ["min-height", "constant-120", "random-walk", "one-step-ahead", "optimal-height", "planner", "local-bandit",
             {"type": "dqn", "epochs": 20}]
})";
constexpr int flights = 3 * 3 * 8;

/// One scratch folder with the experiment in it.
struct Scene {
  ScratchDir scratch;
  std::string experiment = (scratch / "experiment.json").string();

  Scene() { write_text(experiment, experiment_text); }
  [[nodiscard]] std::string out(const std::string& name) const { return (scratch / name).string(); }

  [[nodiscard]] std::vector<std::string> command(const std::string& name,
                                                 const std::vector<std::string>& options) const {
    std::vector<std::string> arguments{"aloft", "run", experiment, "--out", out(name), "--domain", test_domain()};
    arguments.insert(arguments.end(), options.begin(), options.end());
    return arguments;
  }
  [[nodiscard]] std::string digest(const std::string& name, const std::vector<std::string>& options) const {
    const Finished finished = run_command(command(name, options), std::chrono::seconds(120));
    INFO(finished.err);
    CHECK(finished.exit_code == 0);
    return digest_of(name);
  }
  /// Waits for the first results.
  void wait_for_flights(const std::string& name, Command& run) const {
    const std::string of_nothing = "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855\n";
    for (std::string digest; run.running() && (digest.empty() || digest == of_nothing); digest = digest_of(name))
      std::this_thread::sleep_for(std::chrono::milliseconds(50));
  }
  [[nodiscard]] std::string digest_of(const std::string& name) const {
    return run_command({"aloft", "digest", out(name)}).out;
  }
};

std::vector<std::string> shared_memory_files() {
  std::vector<std::string> names;
  for (const auto& entry : std::filesystem::directory_iterator("/dev/shm"))
    names.push_back(entry.path().filename().string());
  std::sort(names.begin(), names.end());
  return names;
}

/// Numbers of threads with which the learning agents of a run were started.
std::set<unsigned> learner_threads(const std::string& out) {
  const std::string flag = std::string("--threads") + '\0';
  std::set<unsigned> threads;
  for (const int pid : aloft::test::processes_with(out)) {
    const std::string command = read_text("/proc/" + std::to_string(pid) + "/cmdline");
    const std::size_t at = command.find(flag);
    if (command.find("aloft-learning-agent") != std::string::npos && at != std::string::npos)
      threads.insert(static_cast<unsigned>(std::stoul(command.substr(at + flag.size()))));
  }
  return threads;
}

}  // namespace

TEST_CASE("the same bytes in process, on 1, 2 and 4 workers, shuffled, and resumed after Ctrl-C") {
  const Scene scene;
  const std::string reference = scene.digest("in-process", {"--in-process", "--workers", "2"});
  CHECK(reference.size() == 65);
  CHECK(scene.digest("in-process-1", {"--in-process", "--workers", "1"}) == reference);
  CHECK(scene.digest("one", {"--workers", "1", "--learner-threads", "3"}) == reference);
  CHECK(scene.digest("two-shuffled", {"--workers", "2", "--shuffled"}) == reference);
  CHECK(scene.digest("four", {"--workers", "4"}) == reference);

  const auto shared_memory = shared_memory_files();
  Command interrupted(scene.command("resumed", {"--workers", "2"}));
  while (interrupted.running() && interrupted.error_so_far().find(" flights") == std::string::npos &&
         !std::filesystem::exists(scene.scratch / "resumed" / "log"))
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  std::set<unsigned> threads;  // learners start later and can have ended by the end
  const auto begin = std::chrono::steady_clock::now();
  while (interrupted.running() &&
         (threads.empty() || std::chrono::steady_clock::now() - begin < std::chrono::milliseconds(1200))) {
    threads.merge(learner_threads(scene.out("resumed")));
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  }
  CHECK(threads == std::set{std::max(1U, usable_cores() / 2)});
  interrupted.send(SIGINT);
  const Finished finished = interrupted.wait(std::chrono::seconds(20));
  CHECK((finished.exit_code == 130 || finished.exit_code == 0));
  CHECK(aloft::test::processes_with(scene.out("resumed")).empty());
  CHECK(shared_memory_files() == shared_memory);
  CHECK(scene.digest("resumed", {"--workers", "2"}) == reference);
}

TEST_CASE("an order in process can be shuffled, too") {
  const Scene scene;
  // With this seed, trial 0 comes late.
  write_text(scene.experiment, R"({"name": "long", "seed": 5, "trials": 500, "world": {"bs_density_per_km2": 5},
                                   "agents": [{"type": "dqn", "epochs": 300}]})");
  const auto first_trial = [&](const std::string& name, const std::vector<std::string>& options) {
    Command run(scene.command(name, options));
    scene.wait_for_flights(name, run);
    run.send(SIGINT);
    CHECK(run.wait(std::chrono::seconds(60)).exit_code == 130);
    const Json flights =
        Json::parse(run_command({"aloft", "export", scene.out(name), "--flights", "--format", "json"}).out);
    return flights.at(0).at("trial").get<int>();
  };
  CHECK(first_trial("in-order", {"--in-process", "--workers", "1"}) == 0);
  CHECK(first_trial("shuffled", {"--in-process", "--workers", "1", "--shuffled"}) > 0);
}

TEST_CASE("what an agent remembers from trial to trial is the same in process, on workers, and through kills") {
  const Scene scene;
  // Two agents with different lineages; a trial waits for the earlier trials that each of them needs.
  const auto experiment = [](const std::string& memory) {
    return R"({"name": "remembering", "seed": 3, "trials": 6,
      "world": {"kind": "generated", "bs_density_per_km2": [1, 5], "steps": 25},
      "agents": ["min-height", "planner",
        {"type": "dqn", "name": "one", "epochs": 4, "hidden_width": 16, "memory": ")" +
           memory + R"("},
        {"type": "dqn", "name": "two", "epochs": 4, "loss": "cross-entropy", "target_network": false, "lineages": 2,
         "memory": ")" +
           memory + R"("}]})";
  };
  write_text(scene.experiment, experiment("per-flight"));
  const std::string forgetful = scene.digest("forgetful", {"--in-process"});
  write_text(scene.experiment, experiment("lifelong"));
  const std::string reference = scene.digest("in-process", {"--in-process", "--workers", "1"});
  CHECK(reference != forgetful);
  CHECK(scene.digest("in-process-2", {"--in-process", "--workers", "2"}) == reference);
  CHECK(scene.digest("one", {"--workers", "1"}) == reference);
  CHECK(scene.digest("two-shuffled", {"--workers", "2", "--shuffled"}) == reference);

  SECTION("interrupted, and resumed in process") {
    Command interrupted(scene.command("resumed", {"--workers", "2"}));
    scene.wait_for_flights("resumed", interrupted);
    interrupted.send(SIGINT);
    const Finished finished = interrupted.wait(std::chrono::seconds(20));
    CHECK((finished.exit_code == 130 || finished.exit_code == 0));
    CHECK(scene.digest("resumed", {"--in-process", "--workers", "2"}) == reference);
  }
  SECTION("every process killed once") {
    Command killed(scene.command("killed", {"--workers", "2"}));
    scene.wait_for_flights("killed", killed);
    for (const char* program : {"aloft-metrics", "aloft-learning-agent", "aloft-channel", "aloft-coordinator"}) {
      for (const int pid : aloft::test::processes_with(scene.out("killed")))
        if (const std::string command = read_text("/proc/" + std::to_string(pid) + "/cmdline");
            command.find(program) != std::string::npos)
          kill(pid, SIGKILL);
      std::this_thread::sleep_for(std::chrono::milliseconds(300));
    }
    const Finished finished = killed.wait(std::chrono::seconds(120));
    INFO(finished.err);
    CHECK(finished.exit_code == 0);
    CHECK(scene.digest_of("killed") == reference);
  }
}

TEST_CASE("site-planner flies the same over a measured flight, with its base stations sent to a worker or not") {
  const Scene scene;
  std::string csv = "step,height_m,throughput_kbps,latitude,longitude,serving_cell\n";
  for (int step = 1; step <= 20; ++step)
    for (int height_m = 20; height_m <= 80; height_m += 10)
      csv += std::to_string(step) + "," + std::to_string(height_m) + "," + std::to_string(90'000 - 500 * height_m) +
             "," + std::to_string(53.34 + 1e-4 * step) + ",-6.24,270000001\n";
  write_text(scene.scratch / "flight.csv", csv);
  write_text(scene.experiment, R"({"name": "sites", "trials": 2, "agents": ["min-height", "site-planner"],
    "world": {"kind": "measured", "file": "flight.csv"}})");
  write_text(scene.scratch / "flight.sites.csv",
             "cell,latitude,longitude,antenna_height_m,power_w,azimuth_deg\n270000001,53.343,-6.235,25,20,270\n"
             "270000002,53.339,-6.246,18,40,30\n");
  const std::string reference = scene.digest("in-process", {"--in-process"});
  CHECK(scene.digest("worker", {"--workers", "1"}) == reference);
  const Json resolved = Json::parse(read_text(scene.scratch / "worker" / "experiment.json"));
  CHECK_THAT(resolved.dump(), Contains("flight.sites.csv"));
}

TEST_CASE("a finished run leaves summary, table, logs and the resolved experiment; running it again only reports") {
  const Scene scene;
  const Finished first = run_command(scene.command("run", {"--workers", "1"}), std::chrono::seconds(120));
  INFO(first.err);
  REQUIRE(first.exit_code == 0);
  CHECK_THAT(first.out, Contains("min-height") && Contains("bit/s/Hz") && Contains("dqn"));
  CHECK_THAT(first.err, Contains(scene.out("run")));

  const Json summary = Json::parse(read_text(scene.scratch / "run" / "summary.json"));
  CHECK(summary["experiment"] == "mixed");
  CHECK(summary["seed"] == 11);
  REQUIRE(summary["conditions"].size() == 3);
  CHECK(summary["conditions"][1]["parameters"]["bs_density_per_km2"] == 5);
  for (const Json& condition : summary["conditions"]) {
    REQUIRE(condition["agents"].size() == 8);
    const Json& agent = condition["agents"]["constant-120"];
    CHECK(agent["trials"] == 3);
    CHECK(condition["agents"]["planner"]["privilege"] == "whole-route");
    if (condition["qos_unit"] == "bit/s/Hz") {
      CHECK(agent["qos_ci95"][0] <= agent["qos_mean"]);
      CHECK(agent["qos_mean"] <= agent["qos_ci95"][1]);
    } else {
      CHECK(agent["qos_ci95"].is_null());  // every flight over a measured world is the same
    }
    CHECK(condition["agents"]["min-height"]["gain_over_min_height_mean"] == 0.0);
    CHECK(condition["agents"]["min-height"]["height_changes_mean"] == 0.0);
  }
  const Json resolved = Json::parse(read_text(scene.scratch / "run" / "experiment.json"));
  CHECK_THAT(resolved.dump(), Contains("\"los_ray\":\"published\"") && Contains("build"));
  CHECK(std::filesystem::exists(scene.scratch / "run" / "summary.csv"));
  CHECK_FALSE(std::filesystem::is_empty(scene.scratch / "run" / "log"));

  const Finished again = run_command(scene.command("run", {"--workers", "1"}));
  CHECK(again.exit_code == 0);
  CHECK(again.out == first.out);
}

TEST_CASE("export gives every flight and every step, as CSV and JSON") {
  const Scene scene;
  REQUIRE(run_command(scene.command("run", {"--in-process"}), std::chrono::seconds(120)).exit_code == 0);
  const std::string dir = scene.out("run");
  const std::string csv = run_command({"aloft", "export", dir, "--flights", "--format", "csv"}).out;
  CHECK(std::count(csv.begin(), csv.end(), '\n') == flights + 1);
  CHECK_THAT(csv, Contains(",seed,trial,agent,agent_type,privilege,qos_unit,") &&
                      Contains(",planner,planner,whole-route,") &&
                      Contains(",one-step-ahead,one-step-ahead,next-step,") && Contains(",dqn,dqn,none,"));
  const Json steps = Json::parse(run_command({"aloft", "export", dir, "--steps", "--format", "json"}).out);
  const Json sample = Json::parse(run_command({"aloft", "inspect", "table", scene.experiment, "--condition", "0",
                                               "--trial", "2", "--format", "json"})
                                      .out);
  CHECK(sample.is_object());
  std::size_t generated_steps = 0;
  for (const Json& step : steps)
    if (step["qos_unit"] == "bit/s/Hz") ++generated_steps;
  CHECK(std::all_of(steps.begin(), steps.end(), [](const Json& step) {
    return (step["privilege"] == "whole-route") == (step["agent"] == "planner");
  }));
  CHECK(generated_steps == 2U * 3 * 8 * 30);
  CHECK(std::all_of(steps.begin(), steps.end(), [](const Json& step) {
    return step["bs_density_per_km2"].is_null() == (step["condition"] == "measured");
  }));
  CHECK(std::all_of(steps.begin(), steps.end(), [](const Json& step) { return step["seed"] == 11; }));
}

TEST_CASE("--agents, --trials, --seed and --set override the file") {
  const Scene scene;
  const Finished finished =
      run_command(scene.command("run", {"--in-process", "--agents", "constant-60,min-height", "--trials", "1", "--seed",
                                        "18446744073709551615", "--set", "worlds.0.bs_density_per_km2=2.5"}));
  INFO(finished.err);
  REQUIRE(finished.exit_code == 0);
  const Json summary = Json::parse(read_text(scene.scratch / "run" / "summary.json"));
  CHECK(summary["seed"] == 18446744073709551615U);
  REQUIRE(summary["conditions"].size() == 2);
  CHECK(summary["conditions"][0]["agents"].size() == 2);
  CHECK(summary["conditions"][0]["agents"]["constant-60"]["trials"] == 1);
}
