// The version is the same in all places.
#include <algorithm>
#include <array>
#include <catch2/catch.hpp>
#include <regex>
#include <sstream>

#include "common/base/build_info.hpp"
#include "tests/integration/command.hpp"
#include "tests/paths.hpp"

using namespace aloft::test;
using Catch::Contains;

namespace {

using Version = std::array<int, 3>;

Version numbers(const std::string& text) {
  Version version{};
  char dot = '.';
  std::istringstream(text) >> version[0] >> dot >> version[1] >> dot >> version[2];
  return version;
}

struct Entry {
  std::string version;  ///< "Unreleased" for changes since the last release
  std::string date;
  std::vector<std::string> kinds;  ///< of changes
  int changes = 0;
};

/// The entries of a changelog in the form of keepachangelog.com, newest first.
std::vector<Entry> entries_of(const std::string& changelog) {
  static const std::regex released(R"(## \[(\d+\.\d+\.\d+)\] - (\d{4}-\d{2}-\d{2}))");
  std::vector<Entry> entries;
  std::istringstream lines(changelog);
  for (std::string line; std::getline(lines, line);) {
    std::smatch match;
    if (std::regex_match(line, match, released))
      entries.push_back({match[1], match[2], {}, 0});
    else if (line == "## [Unreleased]")
      entries.push_back({"Unreleased", "", {}, 0});
    else if (line.starts_with("## "))
      FAIL_CHECK("no heading of a version: " << line);
    else if (line.starts_with("### ") && !entries.empty())
      entries.back().kinds.push_back(line.substr(4));
    else if (line.starts_with("- ") && !entries.empty())
      ++entries.back().changes;
  }
  return entries;
}

std::string value_of(const std::string& text, const std::string& key) {
  const std::regex line("(^|\n)" + key + ": *([^\n]+)");
  std::smatch match;
  return std::regex_search(text, match, line) ? match[2].str() : "";
}

std::string git(const std::string& command) {
  const Finished finished =
      run_command({"/bin/sh", "-c", "git -C '" + source_dir().string() + "' " + command + " 2> /dev/null"});
  return finished.exit_code == 0 ? finished.out : "";
}

const Entry& newest_release(const std::vector<Entry>& entries) {
  const bool unreleased = !entries.empty() && entries.front().version == "Unreleased";
  return entries.at(unreleased ? 1 : 0);
}

}  // namespace

TEST_CASE("CMake, the programs, CITATION.cff and CHANGELOG.md have the same version") {
  const std::string cmake = read_text(source_dir() / "CMakeLists.txt");
  std::smatch match;
  REQUIRE(std::regex_search(cmake, match, std::regex(R"(project\(aloft VERSION (\d+\.\d+\.\d+) )")));
  const std::string version = match[1];
  CHECK_THAT(std::string(aloft::build_id()), Catch::StartsWith(version + "+") || Catch::StartsWith(version + " "));

  const std::vector<Entry> entries = entries_of(read_text(source_dir() / "CHANGELOG.md"));
  const Entry& newest = newest_release(entries);
  CHECK(newest.version == version);

  const std::string citation = read_text(source_dir() / "CITATION.cff");
  CHECK(value_of(citation, "version") == version);
  CHECK(value_of(citation, "date-released") == newest.date);
}

TEST_CASE("CHANGELOG.md has a dated entry per version, newest first, with changes of known kinds") {
  const std::vector<Entry> entries = entries_of(read_text(source_dir() / "CHANGELOG.md"));
  REQUIRE(entries.size() >= 2);
  const std::vector<std::string> known{"Added", "Changed", "Deprecated", "Removed", "Fixed", "Security"};
  for (std::size_t i = 0; i < entries.size(); ++i) {
    INFO(entries[i].version);
    CHECK(entries[i].changes > 0);
    CHECK_FALSE(entries[i].kinds.empty());
    for (const std::string& kind : entries[i].kinds) CHECK(std::find(known.begin(), known.end(), kind) != known.end());
    if (i == 0) continue;
    CHECK(entries[i].version != "Unreleased");
    if (entries[i - 1].version == "Unreleased") continue;
    CHECK(numbers(entries[i].version) < numbers(entries[i - 1].version));
    CHECK(entries[i].date <= entries[i - 1].date);
  }
}

TEST_CASE("every version that is tagged has its entry, and a tagged commit the version of its tag") {
  const std::vector<Entry> entries = entries_of(read_text(source_dir() / "CHANGELOG.md"));
  std::istringstream tags(git("tag --list 'v[0-9]*'"));
  for (std::string tag; tags >> tag;) {
    INFO(tag);
    CHECK(std::any_of(entries.begin(), entries.end(), [&](const Entry& entry) { return "v" + entry.version == tag; }));
  }
  std::istringstream here(git("tag --points-at HEAD --list 'v[0-9]*'"));
  for (std::string tag; here >> tag;) CHECK("v" + newest_release(entries).version == tag);
}

TEST_CASE("CITATION.cff has what the Citation File Format 1.2 requires") {
  const std::string citation = read_text(source_dir() / "CITATION.cff");
  CHECK(value_of(citation, "cff-version") == "1.2.0");
  CHECK_FALSE(value_of(citation, "message").empty());
  CHECK_FALSE(value_of(citation, "title").empty());
  CHECK_THAT(citation, Contains("\nauthors:\n  - "));
  CHECK(value_of(citation, "type") == "software");
  CHECK(value_of(citation, "license") == "BSD-3-Clause");
  CHECK_THAT(read_text(source_dir() / "LICENSE"), Contains("BSD 3-Clause"));
  CHECK(citation.find('\t') == std::string::npos);
}
