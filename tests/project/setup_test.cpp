// tools/quickstart.sh, tools/setup.sh and tools/test.sh install and build what they need, and no more.
#include <catch2/catch.hpp>
#include <set>
#include <sstream>

#include "tests/paths.hpp"
#include "tests/project/scripts.hpp"

using namespace aloft::test;
using Catch::Contains;

namespace {

constexpr const char* debian_13 = "ID=debian\nVERSION_ID=\"13\"\n";

/// What `command` asks apt-get to install on a machine that has nothing.
std::set<std::string> installed_by(const Scripts& scripts, const std::string& command) {
  const Finished finished = scripts.run(command);
  INFO(command << ": " << finished.err);
  CHECK(finished.exit_code == 0);
  const std::string calls = calls_in(finished, {"apt-get"});
  const std::string option = "--no-install-recommends ";
  REQUIRE_THAT(calls, Contains("update\n") && Contains(option));
  std::istringstream words(calls.substr(calls.find(option) + option.size()));
  std::set<std::string> packages;
  for (std::string word; words >> word;) packages.insert(word);
  return packages;
}

}  // namespace

TEST_CASE("the quick start installs and builds the programs alone") {
  const Scripts fresh;
  fresh.use_packages();
  fresh.forget_build();
  const Finished finished = fresh.run("tools/quickstart.sh --trials 3");
  CHECK(finished.exit_code == 0);
  CHECK(calls_in(finished, {"cmake", "aloft"}) ==
        "cmake --preset release -DALOFT_REPORT_CHARTS=OFF -DALOFT_PYTHON=OFF -DALOFT_TESTS=OFF -DALOFT_BENCHMARKS=OFF\n"
        "cmake --build build --target programs\n"
        "aloft run data/experiments/quick.json --trials 3\n");
  const std::set<std::string> packages = installed_by(fresh, "tools/quickstart.sh");
  CHECK(packages.size() < 30);
  CHECK_FALSE(packages.contains("python3-dev"));
  CHECK(packages.contains("libfastcdr-dev"));
  for (const char* later : {"catch2", "chromium", "clang-format-16", "cyclonedds-dev", "docker-compose", "esbuild",
                            "libbenchmark-dev", "libvalijson-dev", "nodejs", "npm", "slurmctld"}) {
    INFO(later);
    CHECK_FALSE(packages.contains(later));
  }
}

TEST_CASE("setup adds the charts, tests add the rest, and what an earlier call has added stays") {
  const Scripts fresh;
  fresh.forget_build();
  CHECK(calls_in(fresh.run("tools/setup.sh")) ==
        "cmake --preset release -DALOFT_REPORT_CHARTS=ON -DALOFT_PYTHON=OFF -DALOFT_TESTS=OFF -DALOFT_BENCHMARKS=OFF\n"
        "cmake --build build --target programs\n");
  CHECK(calls_in(fresh.run("tools/test.sh unit"), {"python_environment.sh", "cmake"}) ==
        "python_environment.sh build/python-venv\n"
        "cmake --preset release -DALOFT_REPORT_CHARTS=ON -DALOFT_PYTHON=ON -DALOFT_TESTS=ON -DALOFT_BENCHMARKS=ON\n"
        "cmake --build build --target tests_unit\n");
  CHECK(calls_in(Scripts().run("tools/setup.sh --for flight"), {"cmake"}) == "cmake --build build --target programs\n");
}

TEST_CASE("for Python only packages are installed, and those of the programs' middleware are not") {
  const Scripts fresh;
  fresh.use_packages();
  fresh.forget_build();
  const std::set<std::string> packages = installed_by(fresh, "tools/setup.sh --for python");
  for (const char* needed : {"build-essential", "cmake", "nlohmann-json3-dev", "python3-dev", "python3-venv"})
    CHECK(packages.contains(needed));
  for (const char* unneeded : {"fastddsgen", "libfastrtps-dev", "libspdlog-dev", "npm", "python3-torch"})
    CHECK_FALSE(packages.contains(unneeded));
  CHECK(calls_in(fresh.run("tools/setup.sh --for python"), {"cmake", "python_environment.sh"}).empty());
}

TEST_CASE("sanitized builds have no Python package") {
  CHECK(calls_in(Scripts().run("tools/setup.sh --for tests asan"), {"cmake", "python_environment.sh"}) ==
        "cmake --build build-asan\n");
}

TEST_CASE("each purpose needs the packages of the one before and some more") {
  const Scripts fresh;
  fresh.use_packages();
  const std::set<std::string> flight = installed_by(fresh, "tools/setup.sh --for flight");
  const std::set<std::string> programs = installed_by(fresh, "tools/setup.sh");
  const std::set<std::string> unit = installed_by(fresh, "tools/test.sh unit");
  const std::set<std::string> all = installed_by(fresh, "tools/test.sh");
  CHECK(flight.size() < programs.size());
  CHECK(std::includes(programs.begin(), programs.end(), flight.begin(), flight.end()));
  CHECK(std::includes(unit.begin(), unit.end(), programs.begin(), programs.end()));
  CHECK(std::includes(all.begin(), all.end(), unit.begin(), unit.end()));
  CHECK(programs.contains("esbuild"));
  CHECK(unit.contains("catch2"));
  CHECK_FALSE(unit.contains("slurmctld"));
  CHECK(all.contains("slurmctld"));
  CHECK_FALSE(all.contains("clang-tidy-16"));
  CHECK(installed_by(fresh, "tools/setup.sh --for lint --install").contains("clang-tidy-16"));
}

TEST_CASE("a package has the name that the release gives it") {
  const Scripts fresh;
  fresh.use_packages();
  const std::set<std::string> twelve = installed_by(fresh, "tools/setup.sh --for integration");
  fresh.call_machine(debian_13);
  const std::set<std::string> thirteen = installed_by(fresh, "tools/setup.sh --for integration");
  CHECK(twelve.contains("libfastrtps-dev"));
  CHECK_FALSE(twelve.contains("libfastdds-dev"));
  CHECK(twelve.contains("clang-format-16"));
  CHECK(thirteen.contains("libfastdds-dev"));
  CHECK_FALSE(thirteen.contains("libfastrtps-dev"));
  CHECK_FALSE(thirteen.contains("clang-format-16"));
  for (const std::set<std::string>& packages : {twelve, thirteen})
    for (const std::string& package : packages) CHECK(package.find_first_of(":[]#") == std::string::npos);
}

TEST_CASE("an unsupported release and an unknown purpose are named with what is allowed, and nothing is done") {
  const Scripts scripts;
  scripts.use_packages();
  const Finished purpose = scripts.run("tools/setup.sh --for fun");
  CHECK(purpose.exit_code == 2);
  CHECK_THAT(purpose.err,
             Contains("'fun'") && Contains("flight, programs, tests, integration, lint, fuzz, packages or python"));
  CHECK(purpose.out.empty());
  for (const auto& [os_release, name] :
       {std::pair("ID=debian\nVERSION_ID=\"11\"\n", "'debian 11'"),
        std::pair("ID=ubuntu\nVERSION_ID=\"24.04\"\n", "'ubuntu 24.04'"),
        std::pair("ID=debian\nNAME=\"Debian GNU/Linux\"\n", "'debian without a version'")}) {
    scripts.call_machine(os_release);
    for (const char* command : {"tools/setup.sh", "tools/quickstart.sh", "tools/test.sh"}) {
      const Finished finished = scripts.run(command);
      INFO(command << " on " << name);
      CHECK(finished.exit_code == 2);
      CHECK_THAT(finished.err, Contains(name) && Contains("supported are Debian 12 and Debian 13"));
      CHECK(finished.out.empty());
    }
  }
}
