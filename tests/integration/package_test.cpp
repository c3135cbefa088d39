// The program finds its data from any working folder, in a build and in an installation.
#include <catch2/catch.hpp>

#include "tests/integration/command.hpp"
#include "tests/paths.hpp"

using aloft::test::bin_dir;
using aloft::test::Finished;
using aloft::test::run_command;
using aloft::test::ScratchDir;
using aloft::test::source_dir;
using Catch::Contains;

namespace {

/// A program started in `folder`.
Finished run_in(const std::filesystem::path& folder, const std::filesystem::path& program,
                const std::vector<std::string>& arguments) {
  std::vector<std::string> command{"/usr/bin/env", "--chdir", folder.string(), program.string()};
  command.insert(command.end(), arguments.begin(), arguments.end());
  return run_command(command);
}

}  // namespace

TEST_CASE("every experiment of the package is found by name and by path from any folder") {
  const ScratchDir elsewhere;
  const std::filesystem::path aloft = bin_dir() / "aloft";
  std::size_t count = 0;
  for (const auto& entry : std::filesystem::directory_iterator(source_dir() / "data/experiments")) {
    const Finished by_name = run_in(elsewhere.path(), aloft, {"validate", entry.path().stem().string()});
    INFO(by_name.err);
    CHECK(by_name.exit_code == 0);
    CHECK_THAT(by_name.out, Contains("valid, experiment id"));
    CHECK(run_in(elsewhere.path(), aloft, {"validate", entry.path().string()}).out == by_name.out);
    CHECK(run_in(source_dir(), aloft, {"validate", entry.path().stem().string()}).out == by_name.out);
    ++count;
  }
  CHECK(count >= 7);
  CHECK(std::filesystem::is_empty(elsewhere.path()));
}

TEST_CASE("a file of that name in the working directory comes before the package's experiment, a folder does not") {
  const ScratchDir here;
  std::filesystem::create_directory(here / "bs-density");
  aloft::test::write_text(here / "quick", R"({"name": "mine", "trials": 1, "world": {}, "agents": ["min-height"]})");
  CHECK_THAT(run_in(here.path(), bin_dir() / "aloft", {"validate", "quick"}).out, Contains("mine: valid"));
  CHECK_THAT(run_in(here.path(), bin_dir() / "aloft", {"validate", "bs-density"}).out, Contains("bs-density: valid"));
}

TEST_CASE("a tournament runs from any folder") {
  const ScratchDir elsewhere;
  const Finished finished =
      run_in(elsewhere.path(), bin_dir() / "aloft",
             {"tournament", "--trials", "2", "--agents", "min-height,random-walk", "--in-process"});
  INFO(finished.err);
  CHECK(finished.exit_code == 0);
  CHECK_THAT(finished.out, Contains("random-walk"));
  CHECK(std::filesystem::exists(elsewhere / "results/tournament/tournament.md"));
}

TEST_CASE("an installed program finds its data in share/aloft beside its bin") {
  const ScratchDir prefix;
  std::filesystem::create_directories(prefix / "bin");
  std::filesystem::create_directories(prefix / "share");
  std::filesystem::copy_file(bin_dir() / "aloft", prefix / "bin/aloft");
  const Finished without = run_in("/", prefix / "bin/aloft", {"validate", "quick"});
  CHECK(without.exit_code == 2);
  CHECK_THAT(without.err, Contains("The package's experiments are missing") &&
                              Contains((prefix / "share/aloft/experiments").string()));
  std::filesystem::copy(source_dir() / "data", prefix / "share/aloft", std::filesystem::copy_options::recursive);
  const Finished with = run_in("/", prefix / "bin/aloft", {"validate", "quick"});
  INFO(with.err);
  CHECK(with.exit_code == 0);
  CHECK(with.out == run_command({"aloft", "validate", "quick"}).out);
}
