// .ci/run and tools/test.sh run the right steps in the right order and lose no failure.
#include <algorithm>
#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include "tests/integration/command.hpp"
#include "tests/paths.hpp"
#include "tests/project/scripts.hpp"

using namespace aloft::test;
using Catch::Contains;

TEST_CASE(
    "CI runs the linter's core, the unit tests under ASan and UBSan, bus and services under TSan, the tier "
    "middleware on Debian 13, then all tests") {
  const Finished finished = Scripts().run(".ci/run");
  REQUIRE(finished.exit_code == 0);
  CHECK_THAT(calls_in(finished), Catch::Matches("cmake --build build\n"
                                                "lint.sh --core\n"
                                                "cmake --build build-asan --target tests_unit\n"
                                                "ctest --test-dir build-asan .*--label-regex \\^unit\\$\n"
                                                "cmake --build build-tsan --target tests_threads\n"
                                                "ctest --test-dir build-tsan .*--label-regex \\^threads\\$\n"
                                                "on_debian.sh debian13 --for tests --online tools/setup.sh --for tests "
                                                "release tests_middleware\n"
                                                "on_debian.sh debian13 --for tests tools/test.sh --preset release "
                                                "middleware\n"
                                                "cmake --build build\n"
                                                "lint.sh --format-only\n"
                                                "ctest --preset release .*\n"));
  INFO("who reads the end of the output finds the counts of ctest, and above them why tests were skipped");
  CHECK_THAT(finished.out, Catch::EndsWith("SKIPPED: no such disk here\n"
                                           "100% tests passed, 0 tests failed out of 1\nTotal: 1 s\n"));
}

TEST_CASE("CI fails with the first step that fails") {
  for (const char* failing :
       {"cmake --build build", "lint.sh --core", "ctest --test-dir build-asan", "ctest --test-dir build-tsan",
        "on_debian.sh debian13 --for tests tools/test.sh", "lint.sh --format-only", "ctest --preset release"}) {
    INFO(failing);
    const Finished finished = Scripts(failing).run(".ci/run");
    CHECK(finished.exit_code != 0);
    const std::string calls = calls_in(finished);
    CHECK_THAT(calls.substr(calls.rfind('\n', calls.size() - 2) + 1), Contains(failing));
  }
}

TEST_CASE("tools/test.sh --all runs the whole linter, both sanitizers over all tiers, and all tests") {
  const Finished finished = Scripts().run("tools/test.sh --all");
  REQUIRE(finished.exit_code == 0);
  CHECK_THAT(calls_in(finished),
             Catch::Matches("cmake --build build\nlint.sh \n"
                            "cmake --build build-asan\nctest --preset asan .*\n"
                            "cmake --build build-tsan\nctest --preset tsan .*\n"
                            "cmake --build build\nlint.sh --format-only\nctest --preset release .*\n"));
  CHECK(Scripts("ctest --preset asan").run("tools/test.sh --all").exit_code != 0);
  CHECK(Scripts("lint.sh").run("tools/test.sh --all").exit_code != 0);
}

TEST_CASE("tools/test.sh --on RELEASE builds with a network and runs the same tests without one") {
  CHECK(calls_in(Scripts().run("tools/test.sh --on debian13 --preset asan unit")) ==
        "on_debian.sh debian13 --for tests --online tools/setup.sh --for tests asan tests_unit\n"
        "on_debian.sh debian13 --for tests tools/test.sh --preset asan unit\n");
  CHECK(calls_in(Scripts().run("tools/test.sh --on debian12")) ==
        "on_debian.sh debian12 --for integration --online tools/setup.sh --for integration release\n"
        "on_debian.sh debian12 --for integration tools/test.sh --preset release\n");
  for (const char* failing : {"--online", "tools/test.sh"})
    CHECK(Scripts(failing).run("tools/test.sh --on debian13").exit_code != 0);
  for (const char* usage : {"--on", "--on debian13 --all", "--on debian13 --lint", "--preset", "fun"}) {
    INFO(usage);
    const Finished finished = Scripts().run(std::string("tools/test.sh ") + usage);
    CHECK(finished.exit_code == 2);
    CHECK_THAT(finished.err, Contains("tools/test.sh --on debian13") && Contains("tools/test.sh --all"));
    CHECK(finished.out.empty());
  }
}

TEST_CASE(
    "ThreadSanitizer looks at every test of bus and services that runs in one process, the tier middleware at bus and "
    "worker; integration tests run alone") {
  const Finished listed = run_command(
      {"/bin/bash", "-c", "ctest --test-dir '" + bin_dir().parent_path().string() + "' --show-only=json-v1"});
  REQUIRE(listed.exit_code == 0);
  const auto property = [](const nlohmann::json& test, const char* name) {
    for (const nlohmann::json& one : test.at("properties"))
      if (one.at("name") == name) return one.at("value");
    return nlohmann::json();
  };
  std::string threads;
  std::string middleware;
  const nlohmann::json all = nlohmann::json::parse(listed.out);
  for (const nlohmann::json& test : all.at("tests")) {
    const nlohmann::json labels = property(test, "LABELS");
    const auto has = [&](const char* label) { return std::find(labels.begin(), labels.end(), label) != labels.end(); };
    if (has("threads")) threads += test.at("name").get<std::string>() + " ";
    if (has("middleware")) middleware += test.at("name").get<std::string>() + " ";
    INFO(test.at("name"));
    if (has("integration") || has("soak")) CHECK(property(test, "RUN_SERIAL") == true);
  }
  for (const char* test :
       {"aloft_bus_tests", "aloft_clear_text_filter_tests", "aloft_rediscovery_tests", "aloft_permissions_tests",
        "aloft_channel_tests", "aloft_agent_host_tests", "aloft_collector_tests", "aloft_coordinator_tests",
        "aloft_http_tests", "aloft_standstill_watch_tests", "aloft_run_view_tests"})
    CHECK_THAT(threads, Contains(test));
  INFO("what is run on another release of Debian in CI");
  for (const char* test : {"aloft_bus_tests", "aloft_rediscovery_tests", "aloft_worker_tests", "aloft_quick_tests"})
    CHECK_THAT(middleware, Contains(test));
}
