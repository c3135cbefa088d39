// A compiler cache must serve a fresh clone at any path.
#include <catch2/catch.hpp>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "tests/paths.hpp"

TEST_CASE("no file is compiled with the path of the checkout in a definition") {
  const std::string checkout = aloft::test::source_dir().string();
  std::ifstream stream(aloft::test::bin_dir().parent_path() / "compile_commands.json");
  const nlohmann::json entries = nlohmann::json::parse(stream);
  REQUIRE(entries.size() > 100);
  for (const nlohmann::json& entry : entries) {
    std::istringstream words(entry.at("command").get<std::string>());
    for (std::string word; words >> word;)
      if (word.starts_with("-D") && word.find(checkout) != std::string::npos)
        FAIL_CHECK(entry.at("file").get<std::string>() << ": " << word);
  }
}
