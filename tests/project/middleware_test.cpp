// The configuration takes the middleware that is supported, and says of any other what is.
#include <catch2/catch.hpp>

#include "tests/integration/command.hpp"
#include "tests/paths.hpp"

using namespace aloft::test;
using Catch::Contains;

namespace {

/// cmake/AloftMiddleware.cmake on a machine where `package` is installed in `version`; no package: none.
Finished configure(const std::string& package, const std::string& version) {
  const ScratchDir machine;
  if (!package.empty()) {
    const std::filesystem::path folder = machine / ("lib/cmake/" + package);
    std::filesystem::create_directories(folder);
    write_text(folder / (package + "-config.cmake"), "");
    write_text(folder / (package + "-config-version.cmake"),
               "set(PACKAGE_VERSION " + version + ")\nset(PACKAGE_VERSION_COMPATIBLE TRUE)\n");
  }
  return run_command({"/usr/bin/cmake", "-DCMAKE_PREFIX_PATH=" + machine.path().string(),
                      "-DCMAKE_FIND_USE_CMAKE_SYSTEM_PATH=FALSE", "-DCMAKE_FIND_USE_SYSTEM_ENVIRONMENT_PATH=FALSE",
                      "-P", (source_dir() / "cmake/AloftMiddleware.cmake").string()});
}

/// CMake breaks lines of messages.
std::string on_one_line(const std::string& text) {
  std::string line;
  for (const char c : text)
    if (c != '\n' && c != ' ')
      line += c;
    else if (!line.empty() && line.back() != ' ')
      line += ' ';
  return line;
}

}  // namespace

TEST_CASE("both generations of the middleware are accepted") {
  CHECK(configure("fastrtps", "2.9.1").exit_code == 0);
  CHECK(configure("fastdds", "3.1.2").exit_code == 0);
  CHECK(configure("fastdds", "3.3.0").exit_code == 0);
}

TEST_CASE("without a supported middleware the configuration names what is supported") {
  const std::string supported =
      "supported: Fast DDS 2.9 (Debian 12: libfastrtps-dev) and 3.1 or later 3.x (Debian 13: "
      "libfastdds-dev)";
  for (const auto& [package, version] :
       {std::pair("fastrtps", "2.8.2"), {"fastrtps", "2.14.0"}, {"fastdds", "3.0.1"}, {"fastdds", "4.0.0"}, {"", ""}}) {
    const Finished refused = configure(package, version);
    CHECK(refused.exit_code != 0);
    const std::string what = *package == '\0' ? "Fast DDS was not found" : std::string(version) + " is not supported";
    CHECK_THAT(on_one_line(refused.err), Contains(what) && Contains(supported));
  }
}
