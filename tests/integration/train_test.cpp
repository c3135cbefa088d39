#include <catch2/catch.hpp>
#include <csignal>
#include <thread>

#include "common/base/error.hpp"
#include "tests/integration/command.hpp"

using namespace aloft;
using namespace aloft::test;
using Catch::Contains;

namespace {

/// Enough rounds that a signal after the first one comes before the last.
const char* const config = R"({
  "spectral_efficiency": {"worlds": 5, "validation_worlds": 3, "rounds": 0, "hidden_width": 8, "updates": 100},
  "throughput": {"worlds": 40, "validation_worlds": 5, "rounds": 40, "hidden_width": 16, "updates": 500, "rollout_steps": 5}
})";

struct Scene {
  Scene() { write_text(scratch / "config.json", config); }

  [[nodiscard]] std::vector<std::string> command(const std::string& out) const {
    return {"aloft", "train",   "pretrained", "--config", (scratch / "config.json").string(),
            "--out", file(out), "--threads",  "2"};
  }
  [[nodiscard]] std::string file(const std::string& name) const { return (scratch / name).string(); }

  /// Starts the training and sends it a signal once it has a checkpoint.
  [[nodiscard]] Finished stopped(const std::string& out, int signal) const {
    Command training(command(out));
    const auto limit = std::chrono::steady_clock::now() + std::chrono::seconds(60);
    while (!std::filesystem::exists(file(out + ".throughput.checkpoint")) && std::chrono::steady_clock::now() < limit)
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
    training.send(signal);
    return training.wait(std::chrono::seconds(60));
  }

  ScratchDir scratch;
};

}  // namespace

TEST_CASE("a training that was killed or interrupted goes on to the same bytes") {
  const Scene scene;
  const Finished whole = run_command(scene.command("whole.pb"), std::chrono::seconds(120));
  INFO(whole.err);
  REQUIRE(whole.exit_code == exit_ok);
  CHECK_THAT(whole.out, Contains("SHA-256"));
  const std::string log = read_text(scene.file("whole.pb.log"));
  CHECK_THAT(log, Contains("throughput round 40: gain over min-height of the best feasible"));

  for (const int signal : {SIGKILL, SIGINT}) {
    const std::string out = signal == SIGKILL ? "killed.pb" : "interrupted.pb";
    const Finished stopped = scene.stopped(out, signal);
    CHECK(stopped.exit_code != exit_ok);
    CHECK_FALSE(std::filesystem::exists(scene.file(out)));
    if (signal == SIGINT) CHECK(stopped.exit_code == exit_interrupted);
    if (signal == SIGINT) CHECK_THAT(stopped.err, Contains("The same command goes on"));
    const Finished resumed = run_command(scene.command(out), std::chrono::seconds(120));
    INFO(resumed.err);
    REQUIRE(resumed.exit_code == exit_ok);
    CHECK_THAT(resumed.err, Contains("throughput: goes on from"));
    CHECK(read_text(scene.file(out)) == read_text(scene.file("whole.pb")));
    CHECK(read_text(scene.file(out + ".log")) == log);
    CHECK_FALSE(std::filesystem::exists(scene.file(out + ".throughput.checkpoint")));
  }
}

TEST_CASE("a checkpoint of another configuration is refused, not used and not overwritten") {
  const Scene scene;
  (void)scene.stopped("model.pb", SIGKILL);
  const std::string checkpoint = scene.file("model.pb.throughput.checkpoint");
  const std::string before = read_text(checkpoint);
  std::string other = config;
  other.replace(other.find("\"rounds\": 40"), 12, "\"rounds\": 41");
  write_text(scene.scratch / "config.json", other);
  const Finished refused = run_command(scene.command("model.pb"), std::chrono::seconds(120));
  CHECK(refused.exit_code == exit_bad_input);
  CHECK_THAT(refused.err, Contains(checkpoint) && Contains("delete it"));
  CHECK(read_text(checkpoint) == before);
}
