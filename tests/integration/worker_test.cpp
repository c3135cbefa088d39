// One worker of real processes; the test acts as coordinator and collector. Every record must hold the same bytes as
// the same flight without a bus.
#include <signal.h>

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <map>
#include <memory>
#include <set>
#include <thread>

#include "common/base/digest.hpp"
#include "common/bus/endpoint.hpp"
#include "common/bus/waiter.hpp"
#include "common/experiment/experiment.hpp"
#include "common/experiment/trial_world.hpp"
#include "common/flight/flight.hpp"
#include "common/store/result_store.hpp"
#include "tests/integration/command.hpp"
#include "tests/paths.hpp"

namespace aloft {
namespace {

using namespace std::chrono_literals;
using Catch::Contains;
using experiment::FlightKey;
using test::Command;
using test::ScratchDir;

const char* const experiment_text = R"({
  "name": "worker-test", "seed": 5, "trials": 3, "energy_weight": 0.001, "handover_cost": 0.5,
  "world": {"kind": "generated", "bs_density_per_km2": [2.5, 5], "steps": 20},
  "agents": ["min-height", "constant-120", "random-walk", "one-step-ahead", "optimal-height", "planner", "site-planner",
             "local-bandit",             {"type": "dqn", "epochs": 5}]
})";

/// The same flights without a bus.
std::map<FlightKey, std::string> expected_traces(const experiment::Experiment& experiment) {
  std::map<FlightKey, std::string> traces;
  for (const experiment::Condition& condition : experiment.conditions)
    for (std::uint32_t trial = 0; trial < experiment.trials; ++trial) {
      const auto map = experiment::make_signal_map(experiment, condition, trial);
      for (const agents::AgentSpec& spec : experiment.agents) {
        if (agents::agent_type(spec.type).foreign) continue;
        const auto agent = spec.make();
        traces[{condition.index, trial, spec.name}] = store::encode_trace(
            flight::fly(*map, experiment.seed, trial, *agent, spec, experiment.costs_in(condition)));
      }
    }
  return traces;
}

std::vector<std::string> shared_memory_files() {
  std::vector<std::string> names;
  for (const auto& entry : std::filesystem::directory_iterator("/dev/shm")) {
    const std::string name = entry.path().filename().string();
    if (name.find("fast") != std::string::npos) names.push_back(name);
  }
  std::sort(names.begin(), names.end());
  return names;
}

/// The rest of the system: assigns all trials at once, checks and confirms the records.
class Scene {
 public:
  explicit Scene(const char* experiment = experiment_text)
      : experiment_(experiment::parse(experiment, "the test")), expected_(expected_traces(experiment_)) {
    waiter_.add(records_);
    waiter_.add(worker_statuses_);
    control(wire::RUN_RUNNING);
    assign_all();
  }

  /// Assigns every trial under a new lease.
  void assign_all() {
    for (const experiment::Condition& condition : experiment_.conditions)
      for (std::uint32_t trial = 0; trial < experiment_.trials; ++trial) assign(++last_lease_, condition.index, trial);
  }

  void kill_and_restart(const std::string& program) {
    processes_.at(program)->send(SIGKILL);
    processes_.at(program)->wait();
    start(program);
  }

  void start_foreign_agent(const std::string& agent, const std::vector<std::string>& more = {}) {
    std::vector<std::string> command{"aloft-foreign-agent", std::to_string(place_.domain), place_.run, "w0", agent};
    command.insert(command.end(), more.begin(), more.end());
    processes_["aloft-foreign-agent"] = std::make_unique<Command>(command);
  }

  void start(const std::string& program) {
    processes_[program] = std::make_unique<Command>(
        std::vector<std::string>{program, "--run", place_.run, "--worker", "w0", "--domain",
                                 std::to_string(place_.domain), "--log-dir", (scratch_ / "log").string()});
  }

  void control(wire::RunState state) {
    wire::RunControl message;
    message.experiment_id(wire::experiment_id(experiment_.id));
    message.state(state);
    message.collector().incarnation(collector);
    message.experiment_json(wire::bytes(experiment_.canonical.dump()));
    controls_.write(message);
  }

  void assign(std::uint64_t lease, std::uint32_t condition, std::uint32_t trial) {
    wire::TrialAssignment message;
    message.worker(wire::name("w0"));
    message.experiment_id(wire::experiment_id(experiment_.id));
    message.lease_id(lease);
    message.condition(condition);
    message.trial(trial);
    message.attempt(1);
    for (const agents::AgentSpec& spec : experiment_.agents)
      message.agents().push_back(wire::names({spec.name}).front());
    assignments_.write(message);
  }

  /// Listens until `done`; false after 60 s (times the slowdown).
  template <class Done>
  bool listen_until(Done done) {
    const auto deadline = std::chrono::steady_clock::now() + 60s * aloft::test::slowdown;
    while (!done()) {
      if (std::chrono::steady_clock::now() > deadline) return false;
      waiter_.wait(50ms);
      records_.drain([this](const wire::EpisodeRecord& record) { on_record(record); });
      worker_statuses_.drain([this](const wire::WorkerStatus& status) { status_ = status; });
    }
    return true;
  }

  void on_record(const wire::EpisodeRecord& record) {
    const FlightKey key{record.condition(), record.trial(), record.agent().to_string()};
    INFO("condition " << key.condition << ", trial " << key.trial << ", agent " << key.agent);
    CHECK(record.episode_id() == experiment::episode_id(experiment_, key));
    if (expected_.contains(key))
      CHECK(wire::view(record.trace()) == expected_.at(key));
    else
      foreign_flights_.push_back(store::decode_trace(wire::view(record.trace())));
    if (++deliveries_[key] == 1 && key == unconfirmed_once_) return;
    wire::EpisodeStored message;
    message.experiment_id(record.experiment_id());
    message.episode_id(record.episode_id());
    message.condition(record.condition());
    message.trial(record.trial());
    message.agent(record.agent());
    message.digest(wire::name(sha256_hex(wire::view(record.trace()))));
    message.collector(collector);
    stored_.write(message);
  }

  [[nodiscard]] bool everything_stored() const {
    const std::size_t flights = experiment_.conditions.size() * experiment_.trials * experiment_.agents.size();
    return deliveries_.size() == flights && status_.leases().empty() && status_.records_unconfirmed() == 0 &&
           status_.flights_done() == flights;
  }
  [[nodiscard]] std::string log(const std::string& program) const {
    return test::read_text(scratch_ / "log" / (program + "-w0.log"));
  }

  ScratchDir scratch_;
  bus::BusOptions place_{.run = "worker-test-" + std::to_string(getpid()) + "-" + std::to_string(++scenes),
                         .worker = "",
                         .process = "worker-test",
                         .domain = std::stoi(test::test_domain())};
  experiment::Experiment experiment_;
  std::map<FlightKey, std::string> expected_;
  std::map<FlightKey, int> deliveries_;
  std::vector<flight::FlightRecord> foreign_flights_;
  FlightKey unconfirmed_once_;
  wire::WorkerStatus status_;
  std::map<std::string, std::unique_ptr<Command>> processes_;

 private:
  static inline int scenes = 0;
  static constexpr std::uint64_t collector = 4711;
  std::uint64_t last_lease_ = 100;
  bus::Participant participant_{place_};
  bus::Writer<wire::RunControl> controls_{participant_};
  bus::Writer<wire::TrialAssignment> assignments_{participant_};
  bus::Writer<wire::EpisodeStored> stored_{participant_};
  bus::Reader<wire::EpisodeRecord> records_{participant_};
  bus::Reader<wire::WorkerStatus> worker_statuses_{participant_};
  bus::Waiter waiter_;
};

}  // namespace

TEST_CASE("a worker of real processes flies the same bytes as one process, and keeps records until they are stored") {
  Scene scene;
  scene.unconfirmed_once_ = {0, 1, "planner"};
  for (const char* program : {"aloft-environment", "aloft-channel", "aloft-learning-agent", "aloft-baseline-agent"})
    scene.start(program);
  CHECK(scene.listen_until([&] { return scene.everything_stored(); }));
  CHECK(scene.deliveries_.size() == scene.expected_.size());
  CHECK(scene.deliveries_[scene.unconfirmed_once_] >= 2);
  CHECK(scene.status_.steps_done() == 20 * scene.expected_.size());
  CHECK(scene.status_.drops() == 0);

  scene.control(wire::RUN_FINISHED);
  for (auto& [program, process] : scene.processes_) {
    INFO(program);
    CHECK(process->wait(20s).exit_code == 0);
  }
}

TEST_CASE("an agent that starts late is waited for by name, and then flies") {
  Scene scene;
  for (const char* program : {"aloft-channel", "aloft-baseline-agent", "aloft-environment"}) scene.start(program);
  const std::string absent = "agents local-bandit, dqn";
  CHECK(scene.listen_until([&] { return wire::view(scene.status_.missing()).find(absent) != std::string_view::npos; }));
  CHECK_THAT(scene.log("aloft-channel"), Contains("waits for " + absent + " (not there)"));
  scene.start("aloft-learning-agent");
  CHECK(scene.listen_until([&] { return scene.everything_stored(); }));
}

TEST_CASE("a killed agent or channel costs time, but no byte") {
  Scene scene;
  for (const char* program : {"aloft-environment", "aloft-channel", "aloft-learning-agent", "aloft-baseline-agent"})
    scene.start(program);
  REQUIRE(scene.listen_until([&] { return !scene.deliveries_.empty(); }));
  SECTION("the learning agent, in the middle of its flights") {
    scene.kill_and_restart("aloft-learning-agent");
    CHECK(scene.listen_until([&] { return scene.everything_stored(); }));
  }
  SECTION("the channel: the trials are leased again") {
    scene.kill_and_restart("aloft-channel");
    scene.assign_all();
    CHECK(scene.listen_until([&] { return scene.everything_stored(); }));
  }
}

TEST_CASE("a foreign program on another DDS implementation flies as min-height, using only our IDL") {
  // Aloft's processes use the loopback interface only; Cyclone DDS has to be configured for that.
  setenv("CYCLONEDDS_URI",
         ("file://" + (aloft::test::source_dir() / "deploy/dds/cyclonedds-loopback.xml").string()).c_str(), 1);
  Scene scene(R"({"name": "foreign-test", "seed": 5, "trials": 3,
                  "world": {"kind": "generated", "bs_density_per_km2": 5, "steps": 20},
                  "agents": ["min-height", {"type": "external", "name": "visitor"}]})");
  for (const char* program : {"aloft-environment", "aloft-channel", "aloft-baseline-agent"}) scene.start(program);
  scene.start_foreign_agent("visitor");
  CHECK(scene.listen_until([&] { return scene.everything_stored(); }));
  CHECK(scene.status_.drops() == 0);
  REQUIRE(scene.foreign_flights_.size() == 3);
  for (const flight::FlightRecord& record : scene.foreign_flights_) {
    CHECK(record.pilots == std::vector<std::string>{"visitor"});
    REQUIRE(record.steps.size() == 20);
    for (const flight::StepRecord& step : record.steps) CHECK(step.height_m == 40.0);
  }
  scene.processes_["aloft-foreign-agent"]->send(SIGTERM);
  CHECK(scene.processes_["aloft-foreign-agent"]->wait(20s).exit_code == 0);
}

TEST_CASE("a foreign program with the site map climbs near the base stations that the map has") {
  setenv("CYCLONEDDS_URI",
         ("file://" + (aloft::test::source_dir() / "deploy/dds/cyclonedds-loopback.xml").string()).c_str(), 1);
  Scene scene(R"({"name": "foreign-test", "seed": 5, "trials": 1,
                  "world": {"kind": "generated", "bs_density_per_km2": 5, "site_map_error_m": 30},
                  "agents": ["min-height", {"type": "external", "name": "visitor", "privilege": "site-map"}]})");
  for (const char* program : {"aloft-environment", "aloft-channel", "aloft-baseline-agent"}) scene.start(program);
  scene.start_foreign_agent("visitor", {"site-map"});
  CHECK(scene.listen_until([&] { return scene.everything_stored(); }));
  REQUIRE(scene.foreign_flights_.size() == 1);

  const experiment::Experiment& experiment = scene.experiment_;
  const auto map = experiment::make_signal_map(experiment, experiment.conditions.front(), 0);
  const auto is_near = [&](const flight::StepRecord& step) {
    return std::ranges::any_of(map->survey()->map.sites, [&](const world::Site& site) {
      return std::hypot(site.position.x_m - step.x_m, site.position.y_m - step.y_m) < 200.0;
    });
  };
  double height_m = 40.0;
  double highest_m = height_m;
  for (const flight::StepRecord& step : scene.foreign_flights_.front().steps) {
    height_m = std::clamp(height_m + (is_near(step) ? 10.0 : -10.0), 40.0, 240.0);
    INFO("step " << step.step);
    CHECK(step.height_m == height_m);
    highest_m = std::max(highest_m, height_m);
  }
  CHECK(highest_m >= 100.0);
}

TEST_CASE("Ctrl-C ends every process of a worker at once and leaves nothing behind") {
  const auto before = shared_memory_files();
  Scene scene;
  for (const char* program : {"aloft-environment", "aloft-channel", "aloft-learning-agent", "aloft-baseline-agent"})
    scene.start(program);
  CHECK(scene.listen_until([&] { return !scene.deliveries_.empty(); }));
  for (const auto& [program, process] : scene.processes_) process->send(SIGINT);
  for (auto& [program, process] : scene.processes_) {
    INFO(program);
    CHECK(process->wait(20s).exit_code == 130);
  }
  CHECK(test::processes_with(scene.place_.run).empty());
  CHECK(shared_memory_files() == before);
}

}  // namespace aloft
