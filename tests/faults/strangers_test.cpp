// Samples that pass the checks of the bus but hold content that no process of Aloft sends: unreadable experiments, and
// text with terminal commands.
#include <signal.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <catch2/catch.hpp>
#include <filesystem>
#include <idl/type_supports.hpp>
#include <thread>

#include "common/store/result_store.hpp"
#include "tests/faults/fault_scene.hpp"
#include "tests/faults/rogue.hpp"

using namespace aloft;
using namespace aloft::test;
using namespace std::chrono_literals;
using Catch::Contains;

namespace {

bus::BusOptions stranger_in(const std::string& run) {
  return {.run = run, .worker = "w0", .process = "rogue", .domain = std::stoi(test_domain())};
}

wire::ExperimentId experiment_of(const FaultScene& scene) {
  return wire::experiment_id(store::ResultStore::open_for_reading(scene.out("reference")).experiment().id);
}

std::size_t count(const std::string& text, const std::string& part) {
  std::size_t found = 0;
  for (auto at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) ++found;
  return found;
}

/// Offers unreadable experiments, again and again, to all present and later readers.
class UnreadableOffers {
 public:
  UnreadableOffers(const bus::BusOptions& place, const wire::ExperimentId& experiment)
      : participant_(place), thread_([this, experiment] { offer(experiment); }) {}
  ~UnreadableOffers() {
    ending_ = true;
    thread_.join();
  }
  UnreadableOffers(const UnreadableOffers&) = delete;
  UnreadableOffers& operator=(const UnreadableOffers&) = delete;

 private:
  void offer(const wire::ExperimentId& experiment) {
    wire::RunControl control;
    control.protocol_version(wire::PROTOCOL_VERSION);
    control.experiment_id(experiment);
    while (!ending_)
      for (const std::string& text :
           {std::string(200'000, '['), std::string(R"({"name": 5})"), std::string("nonsense")}) {
        control.experiment_json(wire::bytes(text));
        rogue_.write(control);
        std::this_thread::sleep_for(20ms);
      }
  }

  bus::Participant participant_;
  Rogue<wire::RunControl, wire::RunControlPubSubType> rogue_{participant_};
  std::atomic<bool> ending_ = false;
  std::thread thread_;
};

}  // namespace

TEST_CASE("unreadable experiments of a foreign process keep no process from the run, however late it starts",
          "[messages]") {
  const FaultScene scene(40);
  const std::string name = "offers";
  const std::string run_name = own_name("offers");
  const UnreadableOffers stranger(stranger_in(run_name), experiment_of(scene));
  const auto run = scene.start(name, {"--workers", "1", "--run", run_name});
  scene.wait_for_flights(name, *run, 20);
  // The same for processes that start long after the coordinator's first offer.
  std::size_t killed = 0;
  for (const int pid : scene.services(name, *run, "--worker w0")) {
    kill(pid, SIGKILL);
    ++killed;
  }
  CHECK(killed == 4);
  scene.check_finished(name, *run, 120s);
  CHECK(count(run->error_so_far(), "starting it again") == killed);
  std::size_t told = 0;
  for (const char* process : {"aloft-environment-w0", "aloft-channel-w0", "aloft-baseline-agent-w0"}) {
    const std::string log = scene.log(name, process);
    const std::size_t here = count(log, "cannot fly the experiment that 'rogue-w0' at 127.0.0.1");
    told += here;
    INFO(log);
    CHECK(here <= 2);  // once for each of two processes
    CHECK(log.size() < 50'000);
  }
  CHECK(told > 0);
}

TEST_CASE("text from the wire can forge no line and control no terminal", "[messages]") {
  const FaultScene scene(60);  // more trials than a worker has worlds in advance
  const std::string name = "text";
  const std::string run_name = own_name("text");
  const auto run = scene.start(name, {"--workers", "1", "--run", run_name});
  scene.wait_for_flights(name, *run, 2);
  const auto environment = [&](int signal) {  // without worlds the run waits for the test
    for (const int pid : scene.services(name, *run, "aloft-environment")) kill(pid, signal);
  };
  environment(SIGSTOP);
  const bus::Participant participant(stranger_in(run_name));

  Rogue<wire::RunStatus, wire::RunStatusPubSubType> coordinator(participant);
  wire::RunStatus status;
  status.protocol_version(wire::PROTOCOL_VERSION);
  status.experiment_id(experiment_of(scene));
  status.message("clear \033[2J\n2026-01-01 aloft: forged\u202e\xff");
  const std::string plain = R"(clear \x1b[2J; 2026-01-01 aloft: forged\u202e\xff)";
  CHECK(eventually(30s, [&] {
    coordinator.write(status);
    return run->error_so_far().find(plain) != std::string::npos;
  }));
  Rogue<wire::AgentStatus, wire::AgentStatusPubSubType> agent(participant);
  wire::AgentStatus news;
  news.protocol_version(wire::PROTOCOL_VERSION);
  news.agent("title \033]0;x\a\nforged");
  CHECK(eventually(30s, [&] {
    agent.write(news);
    return scene.log(name, "aloft-channel-w0").find(R"(agent title \x1b]0;x\x07; forged is there)") !=
           std::string::npos;
  }));
  for (const char* format : {"text", "json"}) {
    const Finished told =
        run_command({"aloft", "status", "--run", run_name, "--domain", test_domain(), "--format", format});
    CHECK_THAT(told.out, Contains("forged"));
    CHECK(std::all_of(told.out.begin(), told.out.end(), [](char c) { return c == '\n' || (c >= ' ' && c <= '~'); }));
  }
  environment(SIGCONT);
  scene.check_finished(name, *run, 120s);
  CHECK(run->error_so_far().find('\033') == std::string::npos);
  for (const auto& log : std::filesystem::directory_iterator(scene.out(name) / "log")) {
    const std::string text = read_text(log.path());
    INFO(text);
    CHECK(text.find('\033') == std::string::npos);
    CHECK(text.find("\nforged") == std::string::npos);
  }
}
