// Agents that share a flight, over real processes: relays with given steps give the same bytes as in process, even with
// kills; standbys take over; swaps by order lose and repeat no step.
#include <signal.h>

#include <algorithm>
#include <atomic>
#include <catch2/catch.hpp>
#include <chrono>
#include <ctime>
#include <fstream>
#include <iostream>
#include <map>
#include <memory>
#include <optional>
#include <sstream>
#include <thread>
#include <utility>

#include "common/bus/endpoint.hpp"
#include "common/bus/waiter.hpp"
#include "common/store/result_store.hpp"
#include "tests/faults/effort.hpp"
#include "tests/integration/command.hpp"

namespace aloft {
namespace {

using namespace std::chrono_literals;
using Catch::Contains;
using test::Command;
using test::Finished;
using test::read_text;
using test::run_command;
using test::ScratchDir;
using test::test_domain;
using test::write_text;

/// Long flights through worlds that are made quickly.
std::string experiment_text(const std::string& on_agent_loss, int trials, int steps, const std::string& crew) {
  return R"({"name": "shared", "seed": 5, "on_agent_loss": ")" + on_agent_loss + R"(", "trials": )" +
         std::to_string(trials) +
         R"(, "world": {"bs_density_per_km2": 5, "window_m": 1000, "route_start_x_m": -400, "route_spacing_m": 0.1, "steps": )" +
         std::to_string(steps) + R"(}, "agents": ["random-walk", {"type": "relay", "name": "uav", "crew": )" + crew +
         "}]}";
}

struct Scene {
  ScratchDir scratch;
  std::string file = (scratch / "experiment.json").string();

  explicit Scene(const std::string& text) { write_text(file, text); }
  [[nodiscard]] std::string out(const std::string& name) const { return (scratch / name).string(); }
  [[nodiscard]] std::vector<std::string> command(const std::string& name,
                                                 const std::vector<std::string>& options) const {
    std::vector<std::string> arguments{"aloft",    "run",         file,    "--out",       out(name),
                                       "--domain", test_domain(), "--run", run_name(name)};
    arguments.insert(arguments.end(), options.begin(), options.end());
    return arguments;
  }
  [[nodiscard]] static std::string run_name(const std::string& name) {
    return "swap-" + name + "-" + std::to_string(getpid());
  }
  [[nodiscard]] std::string digest(const std::string& name, const std::vector<std::string>& options) const {
    const Finished finished = run_command(command(name, options), 120s);
    INFO(finished.err);
    CHECK(finished.exit_code == 0);
    return digest_of(name);
  }
  [[nodiscard]] std::string digest_of(const std::string& name) const {
    return run_command({"aloft", "digest", out(name)}).out;
  }
  [[nodiscard]] std::string log(const std::string& name, const std::string& process) const {
    return read_text(scratch / name / "log" / (process + ".log"));
  }
  /// The process of the run with this program and worker w0.
  [[nodiscard]] int pid_of(const std::string& name, const std::string& program) const {
    for (const int pid : test::processes_with(out(name)))
      if (read_text("/proc/" + std::to_string(pid) + "/cmdline").find(program) != std::string::npos) return pid;
    return 0;
  }
  /// For every flight of the relay the agent that flew each step; checks that every step is there exactly once.
  [[nodiscard]] std::vector<std::vector<std::string>> pilots(const std::string& name) const {
    std::vector<std::vector<std::string>> flights;
    const auto results = store::ResultStore::open_for_reading(scratch / name);
    for (const experiment::FlightKey& key : results.keys()) {
      if (key.agent != "uav") continue;
      const flight::FlightRecord record = store::decode_trace(results.trace(key));
      std::vector<std::string> names;
      for (const flight::StepRecord& step : record.steps) {
        REQUIRE(step.step == names.size() + 1);
        names.push_back(record.pilots.at(step.flown_by));
      }
      flights.push_back(std::move(names));
    }
    return flights;
  }
};

template <typename Condition>
bool eventually(Condition condition, std::chrono::seconds limit = 30s) {
  const auto deadline = std::chrono::steady_clock::now() + limit * test::slowdown;
  while (!condition()) {
    if (std::chrono::steady_clock::now() > deadline) return false;
    std::this_thread::sleep_for(20ms);
  }
  return true;
}

/// When lines with this text were logged, in seconds since the epoch.
std::vector<double> logged_at(const std::string& log, const std::string& text) {
  std::vector<double> times_s;
  std::istringstream lines(log);
  for (std::string line; std::getline(lines, line);) {
    if (line.find(text) == std::string::npos) continue;
    std::tm time{};
    if (strptime(line.c_str(), "%Y-%m-%dT%H:%M:%S", &time) == nullptr) continue;
    time.tm_isdst = -1;
    times_s.push_back(static_cast<double>(std::mktime(&time)) + std::stod(line.substr(19, 4)));
  }
  return times_s;
}

double seconds_since_epoch() {
  return std::chrono::duration<double>(std::chrono::system_clock::now().time_since_epoch()).count();
}

std::size_t changes(const std::vector<std::string>& pilots) {
  std::size_t count = 0;
  for (std::size_t i = 1; i < pilots.size(); ++i) count += pilots[i] != pilots[i - 1] ? 1 : 0;
  return count;
}

/// Gives orders as `aloft swap` does.
class Orders {
 public:
  explicit Orders(const std::string& run)
      : participant_({.run = run, .worker = "w0", .process = "test", .domain = std::stoi(test_domain())}) {
    waiter_.add(replies_);
  }
  [[nodiscard]] bool ready() const { return requests_.matched() > 0 && replies_.matched() > 0; }

  /// Waits until the agent commands all flights in the air. Returns the reply, if there was one.
  std::optional<wire::SwapReply> swap(const std::string& agent) {
    wire::SwapRequest request;
    request.request_id(++last_id_);
    request.agent(wire::name(agent));
    const auto deadline = std::chrono::steady_clock::now() + 60s * test::slowdown;
    std::optional<wire::SwapReply>& reply = last_reply_;
    reply.reset();
    while (std::chrono::steady_clock::now() < deadline) {
      requests_.write(request);
      for (int i = 0; i < 20; ++i) {
        waiter_.wait(50ms);
        replies_.drain([&](const wire::SwapReply& sample) {
          if (sample.request_id() == last_id_) reply = sample;
        });
        if (reply && (!reply->accepted() || reply->flights_waiting() == 0)) return reply;
      }
    }
    return std::nullopt;
  }
  /// The last reply in words, for the message of a failed test.
  [[nodiscard]] std::string last_reply() const {
    if (!last_reply_) return "no reply to the order";
    return std::to_string(last_reply_->flights_waiting()) + " flights wait for the agent that was ordered, " +
           std::to_string(last_reply_->flights_flown()) + " do not";
  }

 private:
  std::optional<wire::SwapReply> last_reply_;
  bus::Participant participant_;
  bus::Writer<wire::SwapRequest> requests_{participant_};
  bus::Reader<wire::SwapReply> replies_{participant_};
  bus::Waiter waiter_;
  std::uint64_t last_id_ = 0;
};

/// The processes of one worker, coordinator and collector, without `aloft run`, which would restart a killed agent
/// before another one has to take over. The test starts the agents.
class SingleProcesses {
 public:
  explicit SingleProcesses(const Scene& scene, const std::string& lanes) : scene_(scene) {
    for (const char* program : {"aloft-metrics", "aloft-coordinator"})
      launch(program, program, {"--results", (scene.scratch / "run" / "results").string(), "--experiment", scene.file});
    start("aloft-environment");
    launch("aloft-channel", "aloft-channel", {"--worker", "w0", "--lanes", lanes});
  }
  /// If `agent` is given, the process hosts only this agent and has its name.
  void start(const std::string& program, const std::string& agent = "") {
    if (agent.empty())
      launch(program, program, {"--worker", "w0"});
    else
      launch(agent, program, {"--worker", "w0", "--agents", agent});
  }
  [[nodiscard]] Command& at(const std::string& name) const { return *processes_.at(name); }

 private:
  void launch(const std::string& name, const std::string& program, const std::vector<std::string>& more) {
    std::vector<std::string> arguments{program,
                                       "--run",
                                       Scene::run_name("run"),
                                       "--domain",
                                       test_domain(),
                                       "--log-dir",
                                       (scene_.scratch / "run" / "log").string()};
    arguments.insert(arguments.end(), more.begin(), more.end());
    processes_[name] = std::make_unique<Command>(arguments);
  }

  const Scene& scene_;
  std::map<std::string, std::unique_ptr<Command>> processes_;
};

/// A busy thread on every core.
class BusyCores {
 public:
  BusyCores() {
    for (unsigned i = 0; i < std::max(1U, std::thread::hardware_concurrency()); ++i)
      threads_.emplace_back([this] {
        while (!ending_) continue;
      });
  }
  ~BusyCores() {
    ending_ = true;
    for (std::thread& thread : threads_) thread.join();
  }
  BusyCores(const BusyCores&) = delete;
  BusyCores& operator=(const BusyCores&) = delete;

 private:
  std::atomic<bool> ending_ = false;
  std::vector<std::thread> threads_;
};

struct Footprint {
  std::size_t memory_kib = 0;
  std::size_t files = 0;
};

Footprint footprint(int pid) {
  const std::string folder = "/proc/" + std::to_string(pid);
  Footprint result;
  std::ifstream status(folder + "/status");
  for (std::string line; std::getline(status, line);)
    if (line.rfind("VmRSS:", 0) == 0) result.memory_kib = std::stoul(line.substr(6));
  for ([[maybe_unused]] const auto& entry : std::filesystem::directory_iterator(folder + "/fd")) ++result.files;
  return result;
}

}  // namespace

TEST_CASE("a relay with given steps: the same bytes in process, over the bus, and with kills") {
  const Scene scene(experiment_text("restart", 3, 60, R"([{"agent": "min-height"},
    {"agent": {"type": "dqn", "epochs": 40}, "from_step": 21},
    {"agent": {"type": "dqn", "epochs": 40, "name": "cold"}, "from_step": 41, "shadow": false},
    {"agent": "constant-80", "from_step": 51},
    {"agent": "site-planner", "from_step": 54}])"));
  const std::string reference = scene.digest("in-process", {"--in-process"});
  CHECK(reference.size() == 65);
  for (const auto& flight : scene.pilots("in-process")) {
    REQUIRE(flight.size() == 60);
    CHECK(flight[19] == "min-height");
    CHECK(flight[20] == "dqn");
    CHECK(flight[40] == "cold");
    CHECK(flight[50] == "constant-80");
    CHECK(flight[53] == "site-planner");
    CHECK(changes(flight) == 4);
  }
  CHECK(scene.digest("two", {"--workers", "2"}) == reference);

  Command killed(scene.command("killed", {"--workers", "1"}));
  for (const char* program : {"aloft-learning-agent", "aloft-baseline-agent"}) {
    int pid = 0;
    REQUIRE(eventually([&] {
      pid = scene.pid_of("killed", program);
      return (pid != 0 && scene.log("killed", "aloft-channel-w0").find("agent dqn is there") != std::string::npos) ||
             !killed.running();
    }));
    std::this_thread::sleep_for(100ms);
    if (pid != 0) kill(pid, SIGKILL);
  }
  const Finished finished = killed.wait(120s);
  INFO(finished.err);
  CHECK(finished.exit_code == 0);
  CHECK(scene.digest_of("killed") == reference);
}

TEST_CASE("failover: after kill -9 of the process that flies, a standby takes over in the documented time") {
  // Two learners, each in its own process, so that the flights last long with either.
  const int steps = test::effort(2000, 4000);
  const Scene scene(experiment_text("failover", test::effort(3, 8), steps, R"([
    {"agent": {"type": "dqn", "name": "first", "epochs": 30, "hidden_width": 64}},
    {"agent": {"type": "dqn", "name": "second", "epochs": 30, "hidden_width": 64}}])"));
  SingleProcesses processes(scene, "1");
  processes.start("aloft-baseline-agent");
  for (const char* agent : {"first", "second"}) processes.start("aloft-learning-agent", agent);
  Orders orders(Scene::run_name("run"));
  REQUIRE(eventually([&] { return orders.ready(); }));
  std::optional<BusyCores> others(std::in_place);
  std::vector<double> waits_s;
  const auto takeovers = [&] { return logged_at(scene.log("run", "aloft-channel-w0"), "agent first is lost in"); };
  const auto over = [&] { return !processes.at("aloft-coordinator").running(); };
  for (int i = 0; i < test::effort(3, 20); ++i) {
    REQUIRE(eventually([&] {  // its process can have just been started
      const auto reply = orders.swap("first");
      return over() || (reply && reply->accepted() && reply->flights_flown() == 1);
    }));
    std::this_thread::sleep_for(100ms * test::slowdown);  // it flies a step: else the flight would not tell of it
    const std::size_t before = takeovers().size();
    const double killed_at = seconds_since_epoch();
    processes.at("first").send(SIGKILL);
    REQUIRE(eventually([&] { return over() || takeovers().size() > before; }));
    if (over()) break;
    waits_s.push_back(takeovers().back() - killed_at);
    processes.start("aloft-learning-agent", "first");
  }
  others.reset();
  REQUIRE(waits_s.size() >= 2);
  std::sort(waits_s.begin(), waits_s.end());
  std::cout << "taken over after";
  for (const double wait_s : waits_s) std::cout << ' ' << wait_s;
  std::cout << " s\n";
  CHECK(waits_s.front() > 0.4);  // the middleware's lease of 0.5 s, less the age of the last sign of life
  CHECK(waits_s.front() < 1.0 * test::slowdown);
  CHECK(waits_s.back() < 5.0 * test::slowdown);

  CHECK(processes.at("aloft-coordinator").wait(180s).exit_code == 0);
  const auto flights = scene.pilots("run/results");  // checks that every step is there once
  CHECK(flights.size() == static_cast<std::size_t>(test::effort(3, 8)));
  std::size_t changed = 0;
  for (const auto& flight : flights) {
    CHECK(flight.size() == static_cast<std::size_t>(steps));
    changed += changes(flight);
  }
  CHECK(changed >= waits_s.size());
  CHECK_THAT(scene.log("run", "aloft-channel-w0"), !Contains("has no history"));
}

TEST_CASE("failover to an agent with the site map, whose process comes long after the map was first told") {
  const int steps = 2000;
  const Scene scene(experiment_text("failover", 2, steps, R"([
    {"agent": {"type": "dqn", "name": "first", "epochs": 200, "hidden_width": 64}}, {"agent": "site-planner"}])"));
  SingleProcesses processes(scene, "1");
  processes.start("aloft-learning-agent", "first");
  Orders orders(Scene::run_name("run"));
  REQUIRE(eventually([&] { return orders.ready(); }));
  processes.start("aloft-baseline-agent", "random-walk");
  const auto log = [&] { return scene.log("run", "aloft-channel-w0"); };
  REQUIRE(eventually([&] { return log().find("agent site-planner is not there") != std::string::npos; }));
  REQUIRE(eventually([&] {
    const auto reply = orders.swap("first");
    return reply && reply->accepted() && reply->flights_flown() == 1;
  }));
  processes.start("aloft-baseline-agent", "site-planner");
  REQUIRE(eventually([&] { return log().find("agent site-planner is there") != std::string::npos; }));
  processes.at("first").send(SIGKILL);
  CHECK(processes.at("aloft-coordinator").wait(180s).exit_code == 0);
  const auto flights = scene.pilots("run/results");  // checks that every step is there once
  REQUIRE(flights.size() == 2);
  CHECK(flights[0].front() == "first");
  for (const auto& flight : flights) {
    REQUIRE(flight.size() == static_cast<std::size_t>(steps));
    CHECK(flight.back() == "site-planner");
  }
}

TEST_CASE("a relay waits once for a member that never comes; its flights are the same") {
  constexpr int trials = 20;
  const std::string crew = R"([{"agent": "min-height"}, {"agent": {"type": "dqn", "epochs": 2, "hidden_width": 8}}])";
  const Scene scene(experiment_text("failover", trials, 50, crew));
  const std::string reference = scene.digest("in-process", {"--in-process"});
  const auto start = std::chrono::steady_clock::now();
  SingleProcesses processes(scene, "1");
  processes.start("aloft-baseline-agent");
  CHECK(processes.at("aloft-coordinator").wait(180s).exit_code == 0);
  // If every trial waited for 3 s, the run would take a minute.
  CHECK(std::chrono::steady_clock::now() - start < trials * 3s * test::slowdown);
  CHECK(scene.digest_of("run/results") == reference);
  CHECK(logged_at(scene.log("run", "aloft-channel-w0"), "agent dqn is not there; relays fly without it").size() == 1);
}

TEST_CASE("many swaps under load: no step lost or doubled, memory and files of all processes flat") {
  const int swaps = test::effort(30, 1000);
  const int trials = std::max(4, swaps / 10);
  // Four flights at a time; the crew has a learner and agents of both agent processes.
  const Scene scene(experiment_text("failover", trials, 2000, R"([{"agent": "min-height"},
    {"agent": {"type": "dqn", "epochs": 2, "hidden_width": 8}}, {"agent": "constant-80"}, {"agent": "site-planner"}])"));
  Command run(scene.command("run", {"--workers", "1"}));
  Orders orders(Scene::run_name("run"));
  REQUIRE(eventually([&] { return orders.ready(); }));
  const BusyCores others;
  const char* const programs[] = {"aloft-channel", "aloft-learning-agent", "aloft-baseline-agent"};
  const char* const agents[] = {"dqn", "constant-80", "site-planner", "min-height"};
  std::map<std::string, Footprint> before;
  int done = 0;
  std::uint64_t taken = 0;
  double waited_s = 0.0;
  for (int i = 0; i < swaps && run.running(); ++i) {
    const double start_s = seconds_since_epoch();
    const auto reply = orders.swap(agents[i % 4]);
    if (!reply && !run.running()) break;
    if (!reply) FAIL(orders.last_reply() << "\n" << scene.log("run", "aloft-channel-w0"));
    waited_s += seconds_since_epoch() - start_s;
    if (!reply->accepted() || reply->flights_flown() == 0) {  // before the agents have joined, or between two trials
      std::this_thread::sleep_for(100ms);
      --i;
      continue;
    }
    ++done;
    taken += reply->flights_flown();
    if (done == swaps / 5)
      for (const char* program : programs) before[program] = footprint(scene.pid_of("run", program));
    if (done == swaps)
      for (const char* program : programs) {
        const Footprint after = footprint(scene.pid_of("run", program));
        INFO(program << ": " << before[program].memory_kib << " KiB, then " << after.memory_kib);
        CHECK(after.files <= before[program].files + 2);
        // Memory still grows during the first swaps.
        if (test::soak() && test::slowdown == 1) CHECK(after.memory_kib < before[program].memory_kib + 10 * 1024);
      }
  }
  CHECK(done == swaps);
  std::cout << done << " swaps of " << taken << " flights, " << 1e3 * waited_s / std::max(1, done) << " ms each\n";
  const Finished finished = run.wait(600s);
  INFO(finished.err);
  CHECK(finished.exit_code == 0);
  const auto flights = scene.pilots("run");  // checks that every step is there once
  CHECK(flights.size() == static_cast<std::size_t>(trials));
  std::size_t changed = 0;
  for (const auto& flight : flights) {
    CHECK(flight.size() == 2000);
    changed += changes(flight);
  }
  // Every flight in the air at an order changed its pilot, unless that agent flew it already.
  CHECK(changed <= taken + flights.size());
  CHECK(changed + 2 * flights.size() >= taken);
  CHECK_THAT(scene.log("run", "aloft-channel-w0"), !Contains("starts again") && !Contains("is lost"));
}

TEST_CASE("aloft swap: what it prints, and what it refuses with exit code 2") {
  // The learner is slow, so that the flights last longer than the test.
  const Scene scene(experiment_text("failover", 2, 8000, R"([{"agent": "min-height"},
    {"agent": {"type": "dqn", "epochs": 300, "hidden_width": 64}}, {"agent": "constant-80"}])"));
  Command run(scene.command("run", {"--workers", "1"}));
  const auto swap = [&](std::vector<std::string> options, const std::string& worker = "w0") {
    options.insert(options.begin(), {"aloft", "swap", "--run", Scene::run_name("run"), "--domain", test_domain(),
                                     "--worker", worker, "--agent"});
    return run_command(options);
  };
  REQUIRE(eventually([&] { return swap({"constant-80"}).out.find("2 flights in the air") != std::string::npos; }));
  Finished finished = swap({"min-height", "--now"});
  CHECK(finished.exit_code == 0);
  CHECK_THAT(finished.out, Contains("min-height flies the 2 flights in the air of worker w0 from now on"));
  finished = swap({"dqn", "--at-step", "8000"});
  CHECK(finished.exit_code == 0);
  CHECK_THAT(finished.out, Contains("from step 8000 on"));

  const auto refused = [&](const Finished& one, const std::string& reason) {
    CHECK(one.exit_code == 2);
    CHECK_THAT(one.err, Contains(reason));
    CHECK(one.out.empty());
  };
  refused(swap({"dqm"}), "Did you mean 'dqn'?");
  refused(swap({"random-walk"}), "in no crew");
  refused(swap({"dqn", "--at-step", "8001"}), "no flight of experiment 'shared' has more than 8000; use 1 to 8000");
  refused(swap({""}), "--agent");
  refused(swap({"dqn", "--at-step", "0"}), "--at-step");
  refused(swap({"dqn", "--at-step", "5", "--now"}), "--now");
  refused(swap({"dqn"}, "w7"), "no worker 'w7'");
  refused(
      run_command({"aloft", "swap", "--run", "nobody", "--domain", test_domain(), "--worker", "w0", "--agent", "dqn"}),
      "nobody flies in run 'nobody'");

  run.send(SIGINT);
  run.wait(30s);
}

TEST_CASE("aloft swap says when no flight is in the air that the agent may fly") {
  // The relay's flight is soon over; the other agent's lasts for minutes.
  const ScratchDir scratch;
  write_text(scratch / "experiment.json", R"({"name": "apart", "seed": 5, "on_agent_loss": "failover", "trials": 1,
    "world": {"bs_density_per_km2": 5, "steps": 100}, "agents": [
      {"type": "dqn", "name": "slow", "epochs": 10000},
      {"type": "relay", "name": "uav", "crew": [{"agent": "min-height"}, {"agent": "constant-80"}]}]})");
  const std::string name = Scene::run_name("apart");
  Command run({"aloft", "run", (scratch / "experiment.json").string(), "--out", (scratch / "out").string(), "--domain",
               test_domain(), "--run", name, "--workers", "1"});
  const auto swap = [&](const std::string& step) {
    return run_command({"aloft", "swap", "--run", name, "--domain", test_domain(), "--worker", "w0", "--agent",
                        "constant-80", "--at-step", step});
  };
  CHECK(eventually([&] {
    return swap("60").out ==
           "worker w0 has no such flight in the air; constant-80 flies those that start later, from step 60 on\n";
  }));
  const Finished beyond = swap("9999");
  CHECK(beyond.exit_code == 2);
  CHECK_THAT(beyond.err, Contains("no flight of experiment 'apart' has more than 100; use 1 to 100"));
  run.send(SIGINT);
  run.wait(30s);
}

}  // namespace aloft
