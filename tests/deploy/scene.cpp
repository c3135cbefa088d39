#include "tests/deploy/scene.hpp"

#include <unistd.h>

#include <catch2/catch.hpp>
#include <thread>

#include "tests/paths.hpp"

namespace aloft::test {

SpreadRun::SpreadRun(int trials) {
  static int runs = 0;
  name_ = "spread-" + std::to_string(getpid()) + "-" + std::to_string(++runs);
  write_text(experiment(), R"({"name": "spread", "seed": 3, "trials": )" + std::to_string(trials) + R"(,
    "world": {"kind": "generated", "bs_density_per_km2": [1, 5], "steps": 40},
    "agents": ["min-height", "random-walk", {"type": "dqn", "epochs": 40}]})");
}

const std::string& SpreadRun::expected_digest() {
  if (expected_.empty()) {
    const std::string reference = (scratch_ / "reference").string();
    const Finished finished =
        run_command({"aloft", "run", experiment(), "--in-process", "--out", reference}, std::chrono::seconds(200));
    INFO(finished.err);
    REQUIRE(finished.exit_code == 0);
    expected_ = run_command({"aloft", "digest", reference}).out;
  }
  return expected_;
}

std::string SpreadRun::digest() const {
  return run_command({"aloft", "digest", out()}).out;
}

std::unique_ptr<Command> SpreadRun::start(const std::string& command, std::vector<std::string> more,
                                          std::vector<std::string> prefix) const {
  std::vector<std::string> arguments = std::move(prefix);
  arguments.emplace_back(arguments.empty() ? "aloft" : (bin_dir() / "aloft").string());
  arguments.push_back(command);
  if (command != "worker") arguments.push_back(experiment());
  arguments.insert(arguments.end(), {command == "worker" ? "--join" : "--run", name_, "--domain", test_domain()});
  if (command != "worker") arguments.insert(arguments.end(), {"--out", out()});
  arguments.insert(arguments.end(), more.begin(), more.end());
  return std::make_unique<Command>(arguments);
}

std::unique_ptr<Command> SpreadRun::coordinator(const std::vector<std::string>& more) const {
  return start("coordinator", more);
}

std::unique_ptr<Command> SpreadRun::metrics(const std::vector<std::string>& more) const {
  return start("metrics", more);
}

std::unique_ptr<Command> SpreadRun::worker(const std::string& name, const std::vector<std::string>& more) const {
  std::vector<std::string> all{"--name", name, "--log-dir", (scratch_ / name).string()};
  all.insert(all.end(), more.begin(), more.end());
  return start("worker", all);
}

bool comes_true(const std::function<bool()>& condition, std::chrono::milliseconds limit) {
  const auto deadline = std::chrono::steady_clock::now() + limit * slowdown;
  while (!condition()) {
    if (std::chrono::steady_clock::now() > deadline) return false;
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
  }
  return true;
}

}  // namespace aloft::test
