#include "tests/install/installed.hpp"

#include <algorithm>
#include <catch2/catch.hpp>

#include "tests/paths.hpp"

namespace aloft::test {
namespace {

/// The installation of this program, removed at its end.
struct Installation {
  Installation() {
    const std::filesystem::path first = scratch / "first";
    const Finished finished = run_command(
        {"/usr/bin/env", "cmake", "--install", bin_dir().parent_path().string(), "--prefix", first.string()},
        std::chrono::seconds(300));
    INFO(finished.out << finished.err);
    REQUIRE(finished.exit_code == 0);
    std::filesystem::rename(first, prefix);
  }
  ScratchDir scratch;
  std::filesystem::path prefix = scratch / "moved";
};

}  // namespace

const std::filesystem::path& installed() {
  static const Installation installation;
  return installation.prefix;
}

std::vector<std::string> files_below(const std::filesystem::path& folder) {
  std::vector<std::string> files;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder))
    if (!entry.is_directory()) files.push_back(entry.path().lexically_relative(folder).string());
  std::sort(files.begin(), files.end());
  return files;
}

}  // namespace aloft::test
