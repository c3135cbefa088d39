// .ci/run and tools/test.sh run the right steps in the right order and lose no failure. Stand-ins replace the programs
// that they call.
#include <algorithm>
#include <catch2/catch.hpp>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "tests/integration/command.hpp"
#include "tests/paths.hpp"

namespace fs = std::filesystem;
using namespace aloft::test;
using Catch::Contains;

namespace {

/// A checkout with the scripts only, in which cmake, ctest and tools/lint.sh print how they were called, and ctest
/// counts one skipped test. The call that contains `failing` fails.
class Scripts {
 public:
  explicit Scripts(const std::string& failing = "no call") {
    for (const char* folder : {"tools", ".ci", "bin", "build", "build-asan", "build-tsan"})
      fs::create_directories(root_ / folder);
    for (const char* script : {".ci/run", "tools/run_ctest.sh", "tools/setup.sh", "tools/test.sh"})
      fs::copy_file(source_dir() / script, root_ / script);
    write_text(root_ / "tools/packages.txt", "# none\n");
    for (const char* folder : {"build", "build-asan", "build-tsan"}) write_text(root_ / folder / "build.ninja", "");
    fs::create_directories(root_ / "build/Testing/Temporary");
    write_text(root_ / "build/Testing/Temporary/LastTest.log", "a test\nSKIPPED: no such disk here\nanother test\n");
    for (const char* program : {"bin/cmake", "bin/ctest", "tools/lint.sh"}) {
      const std::string name = fs::path(program).filename().string();
      const std::string counts =
          name == "ctest" ? "echo '100% tests passed, 0 tests failed out of 1'\necho 'Total: 1 s'\n" : "";
      write_text(root_ / program, "#!/bin/sh\ncall=\"" + name + " $*\"\necho \"$call\"\n" + counts +
                                      "case \"$call\" in *'" + failing + "'*) exit 8 ;; esac\n");
      fs::permissions(root_ / program, fs::perms::owner_all);
    }
  }

  /// Runs a script of the checkout from the file system's root, as a CI could.
  [[nodiscard]] Finished run(const std::string& command) const {
    return run_command(
        {"/bin/bash", "-c", "cd / && PATH=" + (root_ / "bin").string() + ":$PATH " + (root_ / command).string()});
  }

 private:
  ScratchDir root_;
};

std::string calls_of_all_tests(const Finished& finished) {
  std::string calls;
  std::size_t at = 0;
  while (at < finished.out.size()) {
    const std::size_t end = finished.out.find('\n', at);
    const std::string line = finished.out.substr(at, end - at);
    if (line.starts_with("cmake") || line.starts_with("ctest") || line.starts_with("lint.sh")) calls += line + "\n";
    at = end == std::string::npos ? finished.out.size() : end + 1;
  }
  return calls;
}

}  // namespace

TEST_CASE(
    "CI runs the linter's core, the unit tests under ASan and UBSan, bus and services under TSan, then all tests") {
  const Finished finished = Scripts().run(".ci/run");
  REQUIRE(finished.exit_code == 0);
  CHECK_THAT(calls_of_all_tests(finished), Catch::Matches("cmake --build build\n"
                                                          "lint.sh --core\n"
                                                          "cmake --build build-asan --target tests_unit\n"
                                                          "ctest --test-dir build-asan .*--label-regex \\^unit\\$\n"
                                                          "cmake --build build-tsan --target tests_threads\n"
                                                          "ctest --test-dir build-tsan .*--label-regex \\^threads\\$\n"
                                                          "cmake --build build\n"
                                                          "lint.sh --format-only\n"
                                                          "ctest --preset release .*\n"));
  INFO("who reads the end of the output finds the counts of ctest, and above them why tests were skipped");
  CHECK_THAT(finished.out, Catch::EndsWith("SKIPPED: no such disk here\n"
                                           "100% tests passed, 0 tests failed out of 1\nTotal: 1 s\n"));
}

TEST_CASE("CI fails with the first step that fails") {
  for (const char* failing : {"cmake --build build", "lint.sh --core", "ctest --test-dir build-asan",
                              "ctest --test-dir build-tsan", "lint.sh --format-only", "ctest --preset release"}) {
    INFO(failing);
    const Finished finished = Scripts(failing).run(".ci/run");
    CHECK(finished.exit_code != 0);
    const std::string calls = calls_of_all_tests(finished);
    CHECK_THAT(calls.substr(calls.rfind('\n', calls.size() - 2) + 1), Contains(failing));
  }
}

TEST_CASE("tools/test.sh --all runs the whole linter, both sanitizers over all tiers, and all tests") {
  const Finished finished = Scripts().run("tools/test.sh --all");
  REQUIRE(finished.exit_code == 0);
  CHECK_THAT(calls_of_all_tests(finished),
             Catch::Matches("cmake --build build\nlint.sh \n"
                            "cmake --build build-asan\nctest --preset asan .*\n"
                            "cmake --build build-tsan\nctest --preset tsan .*\n"
                            "cmake --build build\nlint.sh --format-only\nctest --preset release .*\n"));
  CHECK(Scripts("ctest --preset asan").run("tools/test.sh --all").exit_code != 0);
  CHECK(Scripts("lint.sh").run("tools/test.sh --all").exit_code != 0);
}

TEST_CASE(
    "ThreadSanitizer looks at every test of bus and services that runs in one process; integration tests run alone") {
  const Finished listed = run_command(
      {"/bin/bash", "-c", "ctest --test-dir '" + bin_dir().parent_path().string() + "' --show-only=json-v1"});
  REQUIRE(listed.exit_code == 0);
  const auto property = [](const nlohmann::json& test, const char* name) {
    for (const nlohmann::json& one : test.at("properties"))
      if (one.at("name") == name) return one.at("value");
    return nlohmann::json();
  };
  std::string threads;
  const nlohmann::json all = nlohmann::json::parse(listed.out);
  for (const nlohmann::json& test : all.at("tests")) {
    const nlohmann::json labels = property(test, "LABELS");
    const auto has = [&](const char* label) { return std::find(labels.begin(), labels.end(), label) != labels.end(); };
    if (has("threads")) threads += test.at("name").get<std::string>() + " ";
    INFO(test.at("name"));
    if (has("integration") || has("soak")) CHECK(property(test, "RUN_SERIAL") == true);
  }
  for (const char* test :
       {"aloft_bus_tests", "aloft_clear_text_filter_tests", "aloft_rediscovery_tests", "aloft_permissions_tests",
        "aloft_channel_tests", "aloft_agent_host_tests", "aloft_collector_tests", "aloft_coordinator_tests",
        "aloft_metrics_http_tests", "aloft_standstill_watch_tests", "aloft_run_view_tests"})
    CHECK_THAT(threads, Contains(test));
}
