// aloft status with real processes: it finds the run by itself, names the agents, and notices lost processes.
#include <signal.h>
#include <unistd.h>

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>
#include <thread>

#include "tests/integration/command.hpp"

using namespace aloft::test;
using Catch::Contains;
using Json = nlohmann::json;

namespace {

/// Far more flights than a test waits for.
const char* const endless_experiment = R"({
  "name": "endless", "seed": 1, "trials": 50000,
  "world": {"kind": "generated", "bs_density_per_km2": 1, "steps": 100},
  "agents": ["min-height", "random-walk", {"type": "dqn", "epochs": 1}]
})";

/// A run on one worker that goes on until the test ends it.
class EndlessRun {
 public:
  EndlessRun()
      : domain_(test_domain()),
        name_("status-test-" + std::to_string(getpid())),
        run_({"aloft", "run", experiment_file(), "--workers", "1", "--run", name_, "--domain", domain_, "--out",
              (scratch_ / "out").string()}) {}
  ~EndlessRun() {
    run_.send(SIGTERM);
    for (int i = 0; i < 1000 && run_.running(); ++i) std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }

  /// The run as `aloft status` shows it; calls again until `wanted` holds, for 30 s (times the slowdown).
  template <class Wanted>
  Json status_until(Wanted wanted) const {
    Json run;
    for (const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(30) * slowdown;
         std::chrono::steady_clock::now() < end;) {
      const Finished status = run_command({"aloft", "status", "--domain", domain_, "--format", "json"});
      const Json all = Json::parse(status.out);
      for (const Json& one : all["runs"])
        if (one["run"] == name_) run = one;
      if (!run.is_null() && wanted(run)) return run;
    }
    FAIL("the last status was " << run.dump(2));
    return run;
  }

  [[nodiscard]] std::vector<int> pids_of(const std::string& program) const {
    std::vector<int> pids;
    for (const int pid : processes_with((scratch_ / "out").string()))
      if (read_text("/proc/" + std::to_string(pid) + "/cmdline").find(program) != std::string::npos)
        pids.push_back(pid);
    return pids;
  }
  [[nodiscard]] const std::string& domain() const { return domain_; }
  [[nodiscard]] const std::string& name() const { return name_; }

 private:
  [[nodiscard]] std::string experiment_file() const {
    const auto file = scratch_ / "endless.json";
    write_text(file, endless_experiment);
    return file.string();
  }

  ScratchDir scratch_;
  std::string domain_;
  std::string name_;
  Command run_;
};

std::string agent_state(const Json& run, const std::string& name) {
  if (run["workers"].empty()) return "no worker";
  for (const Json& agent : run["workers"][0]["agents"])
    if (agent["agent"] == name) return agent["state"];
  return "not there";
}

bool is_there(const Json& run, const std::string& agent) {
  const std::string state = agent_state(run, agent);
  return state == "flying" || state == "ready";
}

}  // namespace

TEST_CASE("status finds a run, shows its progress, and notices lost processes") {
  const EndlessRun endless;
  const Json run = endless.status_until([](const Json& now) {
    return now["flights_stored"] > 0 && now["state"] == "running" && now["collector"]["state"] == "storing" &&
           now["eta_s"].is_number() && now["workers"].size() == 1 && now["workers"][0]["state"] == "alive" &&
           now["workers"][0]["leases"].size() > 0 && agent_state(now, "dqn") == "flying" &&
           is_there(now, "min-height") && is_there(now, "random-walk");
  });
  CHECK(run["experiment"] == "endless");
  CHECK(run["flights_total"] == 150000);
  const std::string version = run_command({"aloft", "--version"}).out;
  REQUIRE_THAT(version, Contains(", Fast DDS "));
  CHECK(run["middleware"] == Json({version.substr(version.find("Fast DDS "),
                                                  version.find_last_not_of('\n') + 1 - version.find("Fast DDS "))}));
  CHECK(run["workers"][0]["worker"] == "w0");
  CHECK(run["workers"][0]["drops"] == 0);

  const Finished text = run_command({"aloft", "status", "--run", endless.name(), "--domain", endless.domain()});
  CHECK(text.exit_code == 0);
  CHECK_THAT(text.out, Contains("run " + endless.name() + ", experiment endless") && Contains("w0") && Contains("dqn"));

  for (const int pid : endless.pids_of("aloft-learning-agent")) kill(pid, SIGSTOP);
  const Json without = endless.status_until([](const Json& now) { return agent_state(now, "dqn") == "lost"; });
  CHECK(agent_state(without, "random-walk") != "lost");
  for (const int pid : endless.pids_of("aloft-learning-agent")) kill(pid, SIGCONT);
}

TEST_CASE("status --watch goes on until Ctrl-C, one JSON object per line") {
  Command watch({"aloft", "status", "--watch", "--format", "json", "--domain", test_domain()});
  std::this_thread::sleep_for(std::chrono::milliseconds(2500) * slowdown);
  CHECK(watch.running());
  watch.send(SIGINT);
  const Finished finished = watch.wait(std::chrono::seconds(20));
  CHECK(finished.exit_code == 0);
  const std::string first = finished.out.substr(0, finished.out.find('\n'));
  CHECK(Json::parse(first)["runs"].is_array());
}

TEST_CASE("status says where it listened when there is no run, and refuses wrong input") {
  const Finished nobody =
      run_command({"aloft", "status", "--run", "no-such-run", "--domain", test_domain(), "--wait", "0.5"});
  CHECK(nobody.exit_code == 1);
  CHECK(nobody.out.empty());
  CHECK_THAT(nobody.err, Contains("no run 'no-such-run' in domain " + test_domain()) && Contains("127.0.0.1") &&
                             Contains("RunStatus") && Contains("--domain"));
  CHECK(run_command({"aloft", "status", "--domain", "102"}).exit_code == 2);
  CHECK(run_command({"aloft", "status", "--run", "a/b"}).exit_code == 2);
  CHECK(run_command({"aloft", "status", "--wait", "0"}).exit_code == 2);
}
