#include "tests/faults/fault_scene.hpp"

#include <fmt/format.h>
#include <signal.h>
#include <unistd.h>

#include <algorithm>
#include <catch2/catch.hpp>
#include <cstdlib>
#include <sstream>
#include <thread>

#include "common/store/result_store.hpp"

namespace aloft::test {

Variable::Variable(const char* name, const std::string& value) : name_(name) {
  setenv(name, value.c_str(), 1);
}

Variable::~Variable() {
  unsetenv(name_);
}

FaultScene::FaultScene(int trials) : trials_(trials) {
  write_text(experiment(), R"({"name": "faults", "seed": 11, "trials": )" + std::to_string(trials) + R"(,
    "world": {"kind": "generated", "bs_density_per_km2": [1, 5], "steps": 20},
    "agents": ["min-height", "random-walk", "one-step-ahead", "planner", "site-planner",
               {"type": "dqn", "epochs": 4, "hidden_width": 16},
               {"type": "dqn", "name": "lifelong", "epochs": 4, "hidden_width": 16, "memory": "lifelong",
                "lineages": 4}]})");
  const Finished finished = run_command(run_arguments("reference", {"--in-process"}), std::chrono::seconds(300));
  INFO(finished.err);
  REQUIRE(finished.exit_code == 0);
  reference_ = digest("reference");
  REQUIRE(reference_.size() == 65);
}

std::vector<std::string> FaultScene::run_arguments(const std::string& name,
                                                   const std::vector<std::string>& options) const {
  std::vector<std::string> arguments{"aloft",    "run",        experiment().string(), "--out", out(name).string(),
                                     "--domain", test_domain()};
  arguments.insert(arguments.end(), options.begin(), options.end());
  return arguments;
}

std::unique_ptr<Command> FaultScene::start(const std::string& name, const std::vector<std::string>& options) const {
  return std::make_unique<Command>(run_arguments(name, options));
}

std::string FaultScene::digest(const std::string& name) const {
  return run_command({"aloft", "digest", out(name).string()}).out;
}

int FaultScene::stored(const std::string& name) const {
  try {
    return static_cast<int>(store::ResultStore::open_for_reading(out(name)).keys().size());
  } catch (const std::exception&) {
    return 0;  // not made yet
  }
}

void FaultScene::wait_for_flights(const std::string& name, Command& run, int flights) const {
  const bool there = eventually(std::chrono::seconds(120), [&] { return !run.running() || stored(name) >= flights; });
  INFO(run.error_so_far());
  REQUIRE(there);
}

std::vector<int> FaultScene::services(const std::string& name, const Command& run, const std::string& part) const {
  std::vector<int> pids = processes_with(out(name).string());
  const std::string command = command_line(run.pid());  // a leak checker's helper process has the same one
  std::erase_if(pids, [&](int pid) {
    const std::string line = command_line(pid);
    return pid == run.pid() || pid == getpid() || line == command || line.find(part) == std::string::npos;
  });
  return pids;
}

std::string FaultScene::log(const std::string& name, const std::string& process) const {
  return read_text(out(name) / "log" / (process + ".log"));
}

void FaultScene::check_finished(const std::string& name, Command& run, std::chrono::seconds limit) const {
  const Finished finished = run.wait(limit);
  INFO(finished.err);
  CHECK(finished.exit_code == 0);
  CHECK(stored(name) == flights());
  CHECK(digest(name) == reference_);
  CHECK(processes_with(out(name).string()).empty());
}

std::string own_name(const std::string& what) {
  return fmt::format("{}-{}", what, getpid());
}

std::size_t resident_bytes(int pid) {
  std::size_t total = 0;
  std::size_t resident = 0;
  std::istringstream(read_text("/proc/" + std::to_string(pid) + "/statm")) >> total >> resident;
  return resident * static_cast<std::size_t>(sysconf(_SC_PAGESIZE));
}

std::string command_line(int pid) {
  std::string text = read_text("/proc/" + std::to_string(pid) + "/cmdline");
  std::replace(text.begin(), text.end(), '\0', ' ');
  return text;
}

bool eventually(std::chrono::seconds limit, const std::function<bool()>& done) {
  const auto deadline = std::chrono::steady_clock::now() + limit * slowdown;
  while (!done()) {
    if (std::chrono::steady_clock::now() > deadline) return false;
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  }
  return true;
}

HeldRun::HeldRun(const FaultScene& scene, std::string name, const Command& run)
    : scene_(scene), name_(std::move(name)), run_(run) {
  const std::vector<int> services = scene.services(name_, run);
  send_environments(SIGSTOP);
  std::this_thread::sleep_for(std::chrono::milliseconds(500));
  for (const int pid : services) {
    INFO(command_line(pid));
    CHECK((bytes_[pid] = resident_bytes(pid)) > 0);
  }
}

void HeldRun::check_growth(const char* attack) {
  std::this_thread::sleep_for(std::chrono::milliseconds(500));
  for (auto& [pid, bytes] : bytes_) {
    INFO(attack << ": " << command_line(pid));
    const std::size_t now = resident_bytes(pid);
    CHECK(now > 0);
    if (memory_tells) CHECK(now < bytes + allowed_growth_bytes);
    bytes = now;
  }
}

void HeldRun::go_on() const {
  send_environments(SIGCONT);
}

void HeldRun::send_environments(int signal) const {
  for (const int pid : scene_.services(name_, run_, "aloft-environment")) kill(pid, signal);
}

}  // namespace aloft::test
