#include "common/base/json_text.hpp"

#include <catch2/catch.hpp>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <regex>
#include <string>

#include "common/base/error.hpp"
#include "common/base/limits.hpp"
#include "tests/paths.hpp"

using namespace aloft;
using Catch::Contains;

namespace {

std::string refusal(const std::string& text) {
  try {
    (void)parse_json(text, "my.json");
  } catch (const InputError& error) {
    return error.what();
  }
  FAIL("accepted: " << text.substr(0, 200));
  return {};
}

std::string nested(std::size_t depth, const std::string& open, const std::string& close) {
  std::string text;
  for (std::size_t i = 0; i < depth; ++i) text += open;
  text += "1";
  for (std::size_t i = 0; i < depth; ++i) text += close;
  return text;
}

}  // namespace

TEST_CASE("only parse_json reads JSON") {
  const std::regex reads_json(R"([jJ]son::parse\s*\()");
  int files = 0;
  for (const char* folder : {"common", "services", "tools"})
    for (const auto& entry : std::filesystem::recursive_directory_iterator(test::source_dir() / folder)) {
      const std::string name = entry.path().filename();
      if (entry.path().extension() != ".cpp" || name.ends_with("_test.cpp") || name == "json_text.cpp") continue;
      std::ifstream stream(entry.path());
      const std::string text{std::istreambuf_iterator<char>(stream), {}};
      INFO(entry.path());
      CHECK_FALSE(std::regex_search(text, reads_json));
      ++files;
    }
  CHECK(files > 100);
}

TEST_CASE("keys keep their order") {
  CHECK(parse_json(R"({"b": 1, "a": [2, "ü"]})", "x").dump() == R"({"b":1,"a":[2,"ü"]})");
}

TEST_CASE("-0.0 is 0.0") {
  CHECK(parse_json("[-0.0, {\"a\": -0e7}, -0, -0.5]", "x").dump() == "[0.0,{\"a\":0.0},0,-0.5]");
}

TEST_CASE("malformed JSON and doubled keys: where, line, column, why") {
  CHECK_THAT(refusal("{\n \"a\": 1,,\n}"), Contains("my.json: line 2, column 9: not valid JSON: "));
  CHECK_THAT(refusal("{\n \"a\": 1,\n \"a\": 2}"), Contains("my.json: line 3, column 4: the key \"a\" stands twice"));
  const std::string key(100'000, 'k');
  CHECK(refusal("{\"" + key + "\": 1, \"" + key + "\": 2}").size() < 300);
  CHECK_THAT(refusal("\"\xff\""), Contains("line 1, column 2: not valid JSON"));
}

TEST_CASE("JSON that is too deep or too large is refused before the rest is read") {
  const std::string limit = "nested more than " + std::to_string(limits::json_depth) + " deep";
  for (const auto& [open, close] : {std::pair{"[", "]"}, std::pair{"{\"a\":", "}"}, std::pair{"[{\"a\":", "}]"}}) {
    const std::size_t per_round = std::string(open).front() == '[' && std::string(open).size() > 1 ? 2 : 1;
    CHECK_NOTHROW(parse_json(nested(limits::json_depth / per_round, open, close), "x"));
    CHECK_THAT(refusal(nested(limits::json_depth / per_round + 1, open, close)), Contains(limit));
    CHECK_THAT(refusal(nested(1'000'000 / per_round, open, "")), Contains("line 1, column ") && Contains(limit));
  }
  CHECK_THAT(refusal("[\n[\n" + nested(200'000, "[", "]") + "]]"),
             Contains("my.json: line 3, column 31: ") && Contains(limit));
  CHECK_THAT(refusal("[" + std::string(limits::json_bytes, ' ') + "]"), Contains("my.json: has 8388610 bytes"));
}
