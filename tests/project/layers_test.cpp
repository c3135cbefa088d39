// Folders include only folders of lower layers, as CONTRIBUTING.md draws them.
#include <catch2/catch.hpp>
#include <filesystem>
#include <map>
#include <regex>
#include <set>
#include <sstream>

#include "tests/integration/command.hpp"
#include "tests/paths.hpp"

namespace aloft::test {
namespace {

namespace fs = std::filesystem;

/// A folder of the repository, e.g. "common/radio" or "tools", and the folders whose headers its sources may include.
using Layers = std::map<std::string, std::set<std::string>>;

std::vector<std::string> split(const std::string& text, const std::regex& separator) {
  return {std::sregex_token_iterator(text.begin(), text.end(), separator, -1), {}};
}

/// Reads the drawing: "tools/  what  -> services, common", and "common/  c > b, a > base", where each folder of common/
/// uses only what is right of the next '>'.
Layers layers_in(const std::string& document) {
  static const std::regex above(R"((\w+)/ .*-> (\w+(?:, \w+)*))");
  static const std::regex within(R"(common/ +(\w+(?:(?: >|,) \w+)+).*)");
  Layers layers;
  std::istringstream lines(document);
  for (std::string line; std::getline(lines, line);) {
    std::smatch match;
    if (std::regex_match(line, match, above)) {
      for (const std::string& folder : split(match[2], std::regex(", "))) layers[match[1]].insert(folder);
    } else if (std::regex_match(line, match, within)) {
      std::vector<std::string> left;
      for (const std::string& level : split(match[1], std::regex(" > "))) {
        const std::vector<std::string> names = split(level, std::regex(", "));
        for (const std::string& name : names) {
          layers["common/" + name];
          for (const std::string& higher : left) layers[higher].insert("common/" + name);
        }
        for (const std::string& name : names) left.push_back("common/" + name);
      }
    }
  }
  return layers;
}

/// The folder in the drawing to which a file or an included header belongs: "common/radio" or "tools".
std::string layer_of(const std::string& path) {
  const std::size_t first = path.find('/');
  if (first == std::string::npos || path.substr(0, first) != "common") return path.substr(0, first);
  return path.substr(0, path.find('/', first + 1));
}

bool is_test(const std::string& path) {
  return path.ends_with("_test.cpp");
}

/// Includes of this source that break the layers, one per line. Tests can use higher layers and tests/.
std::vector<std::string> wrong_includes(const std::string& path, const std::string& source, const Layers& layers) {
  static const std::regex include(R"re(\s*#include "([^"]+)".*)re");
  const std::string own = layer_of(path);
  std::vector<std::string> wrong;
  std::istringstream lines(source);
  for (std::string line; std::getline(lines, line);) {
    std::smatch match;
    if (!std::regex_match(line, match, include)) continue;
    const std::string used = layer_of(match[1]);
    const std::set<std::string>& allowed = layers.at(own);
    const bool of_common = used.starts_with("common/") && allowed.contains("common");
    const bool of_tests = used == "tests" || (used.starts_with("common/") && layers.contains(used));
    if (used != own && !allowed.contains(used) && !of_common && !(is_test(path) && of_tests))
      wrong.push_back(path + " includes " + match[1].str() + ", but " + own + " stands below " + used);
  }
  return wrong;
}

/// Sources of the folders in the drawing, by path from the root.
std::vector<std::string> sources() {
  std::vector<std::string> paths;
  for (const char* root : {"common", "python", "services", "tools"})
    for (const fs::directory_entry& entry : fs::recursive_directory_iterator(source_dir() / root))
      if (std::regex_match(entry.path().filename().string(), std::regex(R"(.*\.(c|h|cpp|hpp)(\.in)?)")))
        paths.push_back(entry.path().lexically_relative(source_dir()).string());
  return paths;
}

const Layers& drawn() {
  static const Layers layers = layers_in(read_text(source_dir() / "CONTRIBUTING.md"));
  return layers;
}

}  // namespace

TEST_CASE("CONTRIBUTING.md draws every folder of common/, and python/, services/ and tools/") {
  for (const char* folder : {"python", "services", "tools"}) CHECK(drawn().contains(folder));
  CHECK(drawn().at("tools").contains("services"));
  for (const fs::directory_entry& entry : fs::directory_iterator(source_dir() / "common"))
    if (entry.is_directory()) CHECK(drawn().contains("common/" + entry.path().filename().string()));
  for (const auto& [folder, below] : drawn()) CHECK(fs::is_directory(source_dir() / folder));
}

TEST_CASE("the build takes the folders of common/ in an order that fits the drawing") {
  static const std::regex line(R"(add_subdirectory\((\w+)\))");
  const std::string list = read_text(source_dir() / "common/CMakeLists.txt");
  std::set<std::string> before;
  for (auto at = std::sregex_iterator(list.begin(), list.end(), line); at != std::sregex_iterator(); ++at) {
    const std::string folder = "common/" + (*at)[1].str();
    for (const std::string& below : drawn().at(folder)) {
      INFO(folder << " stands on " << below);
      CHECK(before.contains(below));
    }
    before.insert(folder);
  }
  CHECK(before.contains("common/bus"));
}

TEST_CASE("no source includes a higher layer") {
  const std::vector<std::string> paths = sources();
  CHECK(paths.size() > 400);
  for (const std::string& path : paths)
    for (const std::string& wrong : wrong_includes(path, read_text(source_dir() / path), drawn())) FAIL_CHECK(wrong);
}

TEST_CASE("an include of a higher or neighbouring layer is found") {
  const Layers layers = layers_in(
      "tools/      the command line        -> services, common\n"
      "services/   one folder per program  -> common\n"
      "common/     bus > flight > learn, radio > base   (each uses only what is right of it)\n");
  CHECK(layers.at("common/radio") == std::set<std::string>{"common/base"});
  const auto wrong = [&](const char* path, const char* included) {
    return wrong_includes(path, "#pragma once\n#include \"" + std::string(included) + "\"\n", layers).size();
  };
  CHECK(wrong("common/radio/map.cpp", "common/base/error.hpp") == 0);
  CHECK(wrong("common/radio/map.cpp", "common/radio/map.hpp") == 0);
  CHECK(wrong("common/bus/wire.cpp", "common/base/error.hpp") == 0);
  CHECK(wrong("common/radio/map.cpp", "common/flight/flight.hpp") == 1);
  CHECK(wrong("common/radio/map.hpp", "common/learn/network.hpp") == 1);
  CHECK(wrong("common/radio/map.cpp", "services/channel/map.hpp") == 1);
  CHECK(wrong("common/radio/map.cpp", "tests/paths.hpp") == 1);
  CHECK(wrong("services/channel/main.cpp", "common/bus/wire.hpp") == 0);
  CHECK(wrong("services/channel/main.cpp", "tools/aloft/help.hpp") == 1);
  CHECK(wrong("tools/aloft/main.cpp", "services/runtime/service.hpp") == 0);
  // Tests can include higher layers, but not the programs.
  CHECK(wrong("common/radio/map_test.cpp", "common/flight/flight.hpp") == 0);
  CHECK(wrong("common/radio/map_test.cpp", "tests/paths.hpp") == 0);
  CHECK(wrong("common/radio/map_test.cpp", "services/channel/map.hpp") == 1);
}

TEST_CASE("no service includes another one; shared code is in folders without a program") {
  static const std::regex include(R"re(#include "services/(\w+)/)re");
  for (const std::string& path : sources()) {
    const std::string source = read_text(source_dir() / path);
    for (auto at = std::sregex_iterator(source.begin(), source.end(), include); at != std::sregex_iterator(); ++at)
      if (const std::string folder = "services/" + (*at)[1].str(); !path.starts_with(folder + "/")) {
        INFO(path << " includes " << folder);
        CHECK_FALSE(fs::exists(source_dir() / folder / "main.cpp"));
      }
  }
}

TEST_CASE("only common/bus includes the middleware") {
  static const std::regex include(R"(#include <(fastdds|fastrtps|fastcdr)/)");
  for (const std::string& path : sources())
    if (!is_test(path) && layer_of(path) != "common/bus" && std::regex_search(read_text(source_dir() / path), include))
      FAIL_CHECK(path << " includes headers of Fast DDS");
}

namespace {

/// The file if any line of it, of common/bus, tests/ or bench/, matches.
std::vector<std::string> sources_with(const std::regex& pattern) {
  std::vector<std::string> found;
  for (const char* root : {"common/bus", "tests", "bench"})
    for (const fs::directory_entry& entry : fs::recursive_directory_iterator(source_dir() / root)) {
      const std::string extension = entry.path().extension().string();
      const std::string path = entry.path().lexically_relative(source_dir()).string();
      if ((extension == ".cpp" || extension == ".hpp") && path != "tests/project/layers_test.cpp" &&
          std::regex_search(read_text(entry.path()), pattern))
        found.push_back(path);
    }
  return found;
}

}  // namespace

TEST_CASE("one header knows the generations of the middleware, and one names its DataWriter") {
  // With "only common/bus includes the middleware".
  CHECK(sources_with(std::regex(R"(F[A-Z]+_VERSION|FAST_DDS_3|has_include|fastrtps/|eprosima::)")) ==
        std::vector<std::string>{"common/bus/middleware/generation.hpp"});
  CHECK(sources_with(std::regex(R"(\bDataWriter\b|_datawriter)")) ==
        std::vector<std::string>{"common/bus/middleware/sample_writer.hpp"});
}

}  // namespace aloft::test
