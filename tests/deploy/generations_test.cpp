// Processes on two generations of the middleware in one run: those of this build, and those of another build, which the
// environment variable ALOFT_OTHER_BIN names by its folder of programs. These must reach the same network and /tmp.
#include <catch2/catch.hpp>
#include <cstdlib>
#include <nlohmann/json.hpp>
#include <set>

#include "tests/deploy/scene.hpp"

using namespace aloft::test;
using namespace std::chrono_literals;

namespace {

bool contains(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

std::string other_aloft() {
  const char* const folder = std::getenv("ALOFT_OTHER_BIN");
  if (folder == nullptr) FAIL("ALOFT_OTHER_BIN names no folder of programs of another build");
  return (std::filesystem::absolute(folder) / "aloft").string();
}

/// "Fast DDS 2.9.1"
std::string middleware_of(const std::string& aloft) {
  const std::string version = run_command({aloft, "--version"}).out;
  const std::size_t at = version.find("Fast DDS ");
  return at == std::string::npos ? version : version.substr(at, version.find('\n') - at);
}

/// Runs `main` as the program that leads the run, with one worker of each build; neither can finish the run alone.
void fly_together(const std::string& main_aloft) {
  SpreadRun run(60);
  Command main({main_aloft, "run", run.experiment(), "--run", run.name(), "--domain", test_domain(), "--out", run.out(),
                "--workers", "0"});
  REQUIRE(comes_true([&] { return contains(main.error_so_far(), "aloft worker --join " + run.name()); }, 30s));
  Command other({other_aloft(), "worker", "--join", run.name(), "--domain", test_domain(), "--name", "other",
                 "--log-dir", run.scratch("other").string(), "--agents", "random-walk,min-height"});
  std::set<std::string> seen;
  std::string last;
  const auto sees_both = [&] {
    const auto status =
        run_command({"aloft", "status", "--run", run.name(), "--domain", test_domain(), "--format", "json"});
    last = status.out + status.err;
    if (status.exit_code != 0) return false;
    const auto report = nlohmann::json::parse(status.out);
    for (const auto& one : report.at("runs"))
      for (const auto& name : one.at("middleware")) seen.insert(name.get<std::string>());
    return seen == std::set<std::string>{middleware_of("aloft"), middleware_of(other_aloft())};
  };
  const auto ours = run.worker("ours", {"--agents", "dqn,min-height"});
  const bool both_seen = comes_true(sees_both, 30s);
  INFO("aloft status says at last " << last);
  CHECK(both_seen);
  const Finished finished = main.wait(120s);
  INFO(finished.err);
  CHECK(finished.exit_code == 0);
  CHECK(ours->wait(30s).exit_code == 0);
  CHECK(other.wait(30s).exit_code == 0);
  CHECK(run.digest() == run.expected_digest());
}

}  // namespace

TEST_CASE("the other build is on another generation of the middleware") {
  const std::string ours = middleware_of("aloft");
  const std::string other = middleware_of(other_aloft());
  INFO(ours << " and " << other);
  CHECK(ours.substr(0, ours.find('.')) != other.substr(0, other.find('.')));
}

TEST_CASE("a worker of the other generation joins our run") {
  fly_together("aloft");
}

TEST_CASE("our worker joins a run of the other generation") {
  fly_together(other_aloft());
}
