// A secured run of real processes: it gives the same bytes, and a process that does not belong to it reads and writes
// nothing and is named in the logs of the run.
#include <signal.h>
#include <unistd.h>

#include <catch2/catch.hpp>
#include <chrono>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <thread>

#include "common/bus/endpoint.hpp"
#include "common/security/keys.hpp"
#include "tests/integration/command.hpp"

using namespace aloft;
using namespace aloft::test;
using namespace std::chrono_literals;
using Catch::Contains;
using security::Role;
namespace fs = std::filesystem;

namespace {

void make_all_keys(const fs::path& dir) {
  security::init_keys(dir, 10);
  for (const Role role : security::all_roles)
    security::issue_keys(dir, {.role = role, .name = std::string(security::to_text(role))}, bus::topic_rights(role),
                         dir);
}

template <class Done>
bool within(std::chrono::milliseconds limit, Done done) {
  const auto end = std::chrono::steady_clock::now() + limit * slowdown;
  while (!done()) {
    if (std::chrono::steady_clock::now() > end) return false;
    std::this_thread::sleep_for(20ms);
  }
  return true;
}

/// Longer than processes of the run need for discovery and the first samples.
constexpr auto patience = 2500ms;

/// A run that goes on until the test ends it, and the keys to join it.
class SecuredRun {
 public:
  SecuredRun() {
    make_all_keys(keys());
    write_text(scratch_ / "endless.json",
               R"({"name": "endless", "seed": 1, "trials": 50000, "on_agent_loss": "failover",
      "world": {"kind": "generated", "bs_density_per_km2": 1, "steps": 100}, "agents": ["random-walk",
        {"type": "relay", "name": "uav", "crew": [{"agent": "min-height"}, {"agent": "constant-120"}]}]})");
    run_.emplace(std::vector<std::string>{"aloft", "run", (scratch_ / "endless.json").string(), "--workers", "1",
                                          "--run", place.run, "--domain", test_domain(), "--out",
                                          (scratch_ / "out").string(), "--secure", keys().string()});
    REQUIRE(within(40s, [&] { return flights_stored() > 0; }));
  }
  ~SecuredRun() {
    run_->send(SIGTERM);
    (void)within(10s, [&] { return !run_->running(); });
  }

  [[nodiscard]] fs::path keys() const { return scratch_ / "keys"; }
  [[nodiscard]] fs::path scratch(const std::string& name) const { return scratch_ / name; }
  [[nodiscard]] std::string log(const std::string& process) const {
    return read_text(scratch_ / "out" / "log" / (process + ".log"));
  }
  [[nodiscard]] bus::BusOptions as(Role role, const fs::path& dir) const {
    bus::BusOptions options = place;
    options.secure = dir;
    options.role = role;
    return options;
  }
  /// Flights stored, as an observer with keys of the run sees it.
  [[nodiscard]] std::uint64_t flights_stored() const {
    const Finished status = run_command({"aloft", "status", "--run", place.run, "--domain", test_domain(), "--secure",
                                         keys().string(), "--format", "json"});
    const auto json = nlohmann::json::parse(status.out);
    return json["runs"].empty() ? 0 : json["runs"][0]["flights_stored"].get<std::uint64_t>();
  }
  [[nodiscard]] bool goes_on() const {
    const std::uint64_t before = flights_stored();
    return within(30s, [&] { return flights_stored() > before; });
  }

  bus::BusOptions place{.run = "secured-" + std::to_string(getpid()),
                        .worker = "",
                        .process = "intruder",
                        .domain = std::stoi(test_domain())};

 private:
  ScratchDir scratch_;
  std::optional<Command> run_;
};

wire::RunControl order_to_stop() {
  wire::RunControl control;
  control.state(wire::RUN_FINISHED);
  return control;
}

wire::TrialAssignment false_assignment() {
  wire::TrialAssignment assignment;
  assignment.worker("w0");
  assignment.lease_id(4711);
  assignment.agents(wire::names({"min-height"}));
  return assignment;
}

/// Gives the holder of keys in `dir` permissions of the test's making, signed by the authority in `authority`.
void permit(const fs::path& authority, const fs::path& dir, Role role, const std::string& name,
            const std::string& rules) {
  const std::string unit(security::to_text(role));
  std::string text = security::permissions_xml({.role = role, .name = name}, bus::topic_rights(role),
                                               "CN=" + name + ",OU=" + unit + ",O=Aloft");
  const std::size_t first = text.find("<allow_rule>");
  text.replace(first, text.find("<default>") - first, rules);
  write_text(dir / unit / "permissions.p7s", security::sign_document(authority, text));
}

std::string rule(const std::string& domains, const std::string& topics) {
  const std::string what = "<topics>" + topics + "</topics><partitions><partition>aloft/*</partition></partitions>";
  return "<allow_rule><domains>" + domains + "</domains><publish>" + what + "</publish><subscribe>" + what +
         "</subscribe></allow_rule>";
}

constexpr const char* everywhere = "<id_range><min>0</min><max>101</max></id_range>";

/// Publishes the order to stop the run and checks that it receives no sample of the run.
void intrude(const bus::BusOptions& writing, const bus::BusOptions& reading) {
  const bus::Participant first(writing);
  const bus::Participant second(reading);
  bus::Writer<wire::RunControl> control(first);
  bus::Writer<wire::TrialAssignment> assignments(first);
  bus::Reader<wire::WorkerStatus> workers(second);
  bus::Reader<wire::TrialAssignment> overheard(second);
  wire::WorkerStatus worker;
  wire::TrialAssignment assignment;
  CHECK_FALSE(within(patience, [&] {
    control.write(order_to_stop());
    assignments.write(false_assignment());
    return workers.take(worker) || overheard.take(assignment);
  }));
}

/// The intruder first only writes to the run and then only reads, since its own reader would receive its writer.
void intrude_both_ways(const bus::BusOptions& intruder) {
  bus::BusOptions elsewhere = intruder;
  elsewhere.run += ".other";
  intrude(intruder, elsewhere);
  intrude(elsewhere, intruder);
}

}  // namespace

TEST_CASE("a secured run flies the same bytes as an unsecured one") {
  const ScratchDir scratch;
  make_all_keys(scratch / "keys");
  write_text(scratch / "experiment.json", R"({"name": "secured", "seed": 11, "trials": 3,
    "world": {"kind": "generated", "bs_density_per_km2": [1, 5], "steps": 30,
              "site_map_error_m": 25, "site_map_route_points": 10},
    "agents": ["min-height", "one-step-ahead", "optimal-height", "planner", "site-filter", {"type": "dqn", "epochs": 5},
               {"type": "dqn", "name": "lifelong", "epochs": 2, "hidden_width": 16, "memory": "lifelong"}]})");
  const auto digest = [&](const std::string& name, const std::vector<std::string>& more) {
    std::vector<std::string> command{"aloft",
                                     "run",
                                     (scratch / "experiment.json").string(),
                                     "--workers",
                                     "2",
                                     "--out",
                                     (scratch / name).string(),
                                     "--domain",
                                     test_domain()};
    command.insert(command.end(), more.begin(), more.end());
    const Finished finished = run_command(command, 120s);
    INFO(finished.err);
    CHECK(finished.exit_code == 0);
    return run_command({"aloft", "digest", (scratch / name).string()}).out;
  };
  const std::string reference = digest("in-process", {"--in-process"});
  CHECK(reference.size() == 65);
  CHECK(digest("secured", {"--secure", (scratch / "keys").string()}) == reference);
}

TEST_CASE("the order to stop by which intruders are tested does end an unsecured run") {
  ScratchDir scratch;
  bus::BusOptions place{.run = "open-" + std::to_string(getpid()),
                        .worker = "",
                        .process = "intruder",
                        .domain = std::stoi(test_domain())};
  Command environment({"aloft-environment", "--run", place.run, "--domain", test_domain(), "--worker", "w0"});
  const bus::Participant participant(place);
  bus::Writer<wire::RunControl> control(participant);
  CHECK(within(20s, [&] {
    control.write(order_to_stop());
    return !environment.running();
  }));
}

TEST_CASE("intruders read and write nothing, and are named") {
  const SecuredRun run;
  const auto log_of_all = [&] {
    return run.log("aloft-coordinator") + run.log("aloft-environment-w0") + run.log("aloft-channel-w0");
  };
  {
    INFO("without keys");
    bus::BusOptions unknown = run.place;
    unknown.process = "unknown";
    intrude_both_ways(unknown);
    for (const char* log : {"aloft-coordinator", "aloft-environment-w0", "aloft-channel-w0", "aloft-metrics"})
      CHECK_THAT(run.log(log), Contains("refused a participant: 'unknown' at 127.0.0.1 shows no certificate"));
  }
  {
    INFO("with keys of another authority, which allows everything");
    const fs::path foreign = run.scratch("foreign");
    make_all_keys(foreign);
    permit(foreign, foreign, Role::coordinator, "coordinator", rule(everywhere, "<topic>*</topic>"));
    bus::BusOptions foreigner = run.as(Role::coordinator, foreign);
    foreigner.process = "foreigner";
    intrude_both_ways(foreigner);
    for (const char* log : {"aloft-coordinator", "aloft-environment-w0", "aloft-channel-w0", "aloft-metrics"})
      CHECK_THAT(run.log(log), Contains("refused a participant: 'foreigner' at 127.0.0.1") &&
                                   Contains("shows a certificate of another authority"));
  }
  {
    INFO("with the keys of an agent");
    const bus::Participant agent(run.as(Role::learning_agent, run.keys()));
    CHECK_THROWS_WITH(bus::Writer<wire::TrialAssignment>(agent),
                      Contains("TrialAssignment") && Contains("'learning-agent'"));
    CHECK_THROWS_WITH(bus::Reader<wire::WorkerStatus>(agent), Contains("WorkerStatus") && Contains("'learning-agent'"));
  }
  {
    INFO("with the keys of an agent, and a middleware that allows its own process everything");
    // The middleware checks the topics of its own process without the domain, but those of others with it. So rules for
    // another domain simulate a program whose own checks were removed.
    const fs::path keys = run.scratch("agent");
    security::issue_keys(run.keys(), {.role = Role::learning_agent, .name = "mallory"},
                         bus::topic_rights(Role::learning_agent), keys);
    permit(run.keys(), keys, Role::learning_agent, "mallory",
           rule("<id>" + test_domain() + "</id>", "<topic>HeightCommand</topic>") +
               rule("<id>101</id>", "<topic>*</topic>"));
    bus::BusOptions agent = run.as(Role::learning_agent, keys);
    agent.process = "tampered";
    intrude_both_ways(agent);
    CHECK_THAT(run.log("aloft-environment-w0"),
               Contains("refused to let 'tampered' at 127.0.0.1") && Contains("write TrialAssignment"));
    CHECK_THAT(run.log("aloft-coordinator"), Contains("read TrialAssignment"));
    CHECK_THAT(run.log("aloft-channel-w0"), Contains("read WorkerStatus") && Contains("write RunControl"));
  }
  CHECK_THAT(log_of_all(), !Contains("is over"));
  CHECK(run.goes_on());
}

TEST_CASE("a process with an operator's keys can order a swap, and nothing else") {
  const SecuredRun run;
  const auto swap = [&](const fs::path& keys) {
    return run_command({"aloft", "swap", "--run", run.place.run, "--domain", test_domain(), "--worker", "w0", "--agent",
                        "constant-120", "--secure", keys.string()});
  };
  {
    INFO("observer");
    const fs::path keys = run.scratch("observer");
    security::issue_keys(run.keys(), {.role = Role::observer, .name = "alice"}, bus::topic_rights(Role::observer),
                         keys);
    const Finished refused = swap(keys);
    CHECK(refused.exit_code == 2);
    CHECK_THAT(refused.err, Contains("operator/cert.pem: is missing") && Contains("aloft keys issue"));
    bus::BusOptions options = run.as(Role::observer, keys);
    options.worker = "w0";
    CHECK_THROWS_WITH(bus::Writer<wire::SwapRequest>(bus::Participant(options)),
                      Contains("SwapRequest") && Contains("'observer'"));
  }
  {
    INFO("operator");
    bus::BusOptions options = run.as(Role::run_operator, run.keys());
    options.worker = "w0";
    const bus::Participant participant(options);
    CHECK_THROWS_WITH(bus::Writer<wire::TrialAssignment>(participant), Contains("TrialAssignment"));
    CHECK_THROWS_WITH(bus::Writer<wire::RunControl>(participant), Contains("RunControl"));
    CHECK_THROWS_WITH(bus::Writer<wire::HeightCommand>(participant), Contains("HeightCommand"));
    const Finished done = swap(run.keys());
    INFO(done.err);
    CHECK(done.exit_code == 0);
    CHECK_THAT(done.out, Contains("constant-120 flies"));
  }
  CHECK(run.goes_on());
}

TEST_CASE("a process with an observer's keys sees flights in the air, and nothing else of a worker") {
  const SecuredRun run;
  bus::BusOptions options = run.as(Role::observer, run.keys());
  options.worker = "w0";
  {
    const bus::Participant observer(options);
    const bus::ReaderOptions looking_on{.looks_on = true};
    bus::Reader<wire::ChannelReport> reports(observer, looking_on);
    bus::Reader<wire::HeightCommand> commands(observer, looking_on);
    wire::ChannelReport report;
    wire::HeightCommand command;
    CHECK(within(10s, [&] { return reports.take(report); }));
    CHECK(within(10s, [&] { return commands.take(command); }));
    CHECK_THROWS_WITH(bus::Writer<wire::HeightCommand>(observer), Contains("HeightCommand"));
    CHECK_THROWS_WITH(bus::Writer<wire::ChannelReport>(observer), Contains("ChannelReport"));
    CHECK_THROWS_WITH(bus::Reader<wire::HeightProfile>(observer), Contains("HeightProfile"));
    CHECK_THROWS_WITH(bus::Reader<wire::SiteMap>(observer), Contains("SiteMap"));
  }
  {
    INFO("keys from before these rights");
    const fs::path old = run.scratch("old");
    security::TopicRights rights = bus::topic_rights(Role::observer);
    std::erase(rights.reads, "ChannelReport");
    security::issue_keys(run.keys(), {.role = Role::observer, .name = "old"}, rights, old);
    options.secure = old;
    CHECK_THROWS_WITH(bus::Reader<wire::ChannelReport>(bus::Participant(options)),
                      Contains("ChannelReport") && Contains("do the permissions of the role 'observer'"));
    const Finished refused = run_command(
        {"aloft", "live", "--run", run.place.run, "--domain", test_domain(), "--operator", "--secure", old.string()});
    CHECK(refused.exit_code == 2);
    CHECK_THAT(refused.err, Contains("operator/cert.pem: is missing"));
  }
  CHECK(run.goes_on());
}

TEST_CASE("a process refuses to start with wrong keys") {
  const ScratchDir scratch;
  const fs::path keys = scratch / "keys";
  make_all_keys(keys);
  const std::string experiment = "data/experiments/quick.json";
  fs::permissions(keys / "channel" / "key.pem", fs::perms(0644));
  const std::vector<std::vector<std::string>> commands{
      {"aloft-channel", "--worker", "w0", "--secure", keys.string()},
      {"aloft", "run", experiment, "--out", (scratch / "out").string(), "--secure", keys.string()}};
  for (std::vector<std::string> command : commands) {
    const std::string program = command.front();
    INFO(program);
    command.insert(command.end(), {"--domain", test_domain()});
    const Finished finished = run_command(command);
    CHECK(finished.exit_code == 2);
    CHECK_THAT(finished.err, Contains("channel/key.pem: other users can read this private key (mode 644); chmod 600"));
  }
  CHECK_FALSE(fs::exists(scratch / "out"));
  // A run with nothing left to fly checks the keys, too.
  std::vector<std::string> run{
      "aloft", "run", experiment, "--trials", "1", "--agents", "min-height", "--out", (scratch / "done").string()};
  run.push_back("--in-process");
  REQUIRE(run_command(run).exit_code == 0);
  run.back() = "--secure";
  run.push_back(keys.string());
  const Finished finished_run = run_command(run);
  CHECK(finished_run.exit_code == 2);
  CHECK_THAT(finished_run.err, Contains("channel/key.pem: other users can read this private key"));
  const Finished missing = run_command({"aloft", "status", "--secure", (scratch / "nowhere").string()});
  CHECK(missing.exit_code == 2);
  CHECK_THAT(missing.err, Contains("nowhere: there is no such folder") && Contains("aloft keys init"));
}

TEST_CASE("aloft keys makes what --secure takes") {
  const ScratchDir scratch;
  const std::string dir = (scratch / "keys").string();
  CHECK(run_command({"aloft", "keys", "init", dir}).exit_code == 0);
  const Finished issued = run_command({"aloft", "keys", "issue", dir, "channel", "learning-agent", "--name", "alpha",
                                       "--out", (scratch / "alpha").string()});
  CHECK(issued.exit_code == 0);
  CHECK_NOTHROW(security::check_keys(scratch / "alpha", Role::channel));
  CHECK_NOTHROW(security::check_keys(scratch / "alpha", Role::learning_agent));
  CHECK(run_command({"aloft", "keys", "issue", dir, "all"}).exit_code == 0);
  for (const Role role : security::all_roles) CHECK_NOTHROW(security::check_keys(dir, role));

  const Finished again = run_command({"aloft", "keys", "init", dir});
  CHECK(again.exit_code == 2);
  CHECK_THAT(again.err, Contains("holds an authority already"));
  const Finished pilot = run_command({"aloft", "keys", "issue", dir, "pilot"});
  CHECK(pilot.exit_code == 2);
  CHECK_THAT(pilot.err, Contains("there is no role 'pilot'") && Contains("learning-agent"));
  CHECK(run_command({"aloft", "keys", "issue", dir, "channel", "--name", "a b"}).exit_code == 2);
  CHECK(run_command({"aloft", "keys", "issue", (scratch / "none").string(), "channel"}).exit_code == 2);
}
