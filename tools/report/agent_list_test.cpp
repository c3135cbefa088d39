#include "tools/report/agent_list.hpp"

#include <algorithm>
#include <array>
#include <catch2/catch.hpp>
#include <cmath>
#include <nlohmann/json.hpp>
#include <set>
#include <utility>

#include "tools/report/test_trials.hpp"

using namespace aloft::report;
using aloft::agents::Look;
using aloft::report::testing::agent;
using aloft::report::testing::condition;
using nlohmann::json;

namespace {

using Linear = std::array<double, 3>;  ///< linear sRGB, 0 to 1
using Eye = std::array<Linear, 3>;     ///< rows of a matrix over linear sRGB

/// Machado, Oliveira, Fernandes: A Physiologically-based Model for Simulation of Color Vision Deficiency, 2009,
/// severity 1.
constexpr Eye protanopia{
    {{0.152286, 1.052583, -0.204868}, {0.114503, 0.786281, 0.099216}, {-0.003882, -0.048116, 1.051998}}};
constexpr Eye deuteranopia{
    {{0.367322, 0.860646, -0.227968}, {0.280085, 0.672501, 0.047413}, {-0.011820, 0.042940, 0.968881}}};

/// "#rrggbb" by the transfer function of sRGB (IEC 61966-2-1).
Linear linear(const std::string& hex) {
  Linear colour{};
  for (std::size_t i = 0; i < 3; ++i) {
    const double part = std::stoi(hex.substr(1 + 2 * i, 2), nullptr, 16) / 255.0;
    colour[i] = part <= 0.04045 ? part / 12.92 : std::pow((part + 0.055) / 1.055, 2.4);
  }
  return colour;
}

Linear product(const Eye& matrix, const Linear& of) {
  Linear result{};
  for (std::size_t i = 0; i < 3; ++i) result[i] = matrix[i][0] * of[0] + matrix[i][1] * of[1] + matrix[i][2] * of[2];
  return result;
}

Linear seen_by(const Eye& eye, const Linear& colour) {
  Linear seen = product(eye, colour);
  for (double& part : seen) part = std::clamp(part, 0.0, 1.0);
  return seen;
}

/// Ottosson: A perceptual color space for image processing, 2020.
Linear as_oklab(const Linear& colour) {
  constexpr Eye cones{{{0.4122214708, 0.5363325363, 0.0514459929},
                       {0.2119034982, 0.6806995451, 0.1073969566},
                       {0.0883024619, 0.2817188376, 0.6299787005}}};
  constexpr Eye lab{{{0.2104542553, 0.7936177850, -0.0040720468},
                     {1.9779984951, -2.4285922050, 0.4505937099},
                     {0.0259040371, 0.7827717662, -0.8086757660}}};
  Linear roots = product(cones, colour);
  for (double& part : roots) part = std::cbrt(part);
  return product(lab, roots);
}

double distance(const Linear& a, const Linear& b) {
  return std::hypot(a[0] - b[0], a[1] - b[1], a[2] - b[2]);
}

/// The contrast ratio of WCAG 2.2.
double contrast(const std::string& a, const std::string& b) {
  const auto luminance = [](const std::string& hex) {
    const Linear colour = linear(hex);
    return 0.2126 * colour[0] + 0.7152 * colour[1] + 0.0722 * colour[2];
  };
  const auto [low, high] = std::minmax({luminance(a), luminance(b)});
  return (high + 0.05) / (low + 0.05);
}

json listed(std::vector<AgentTrials> agents) {
  const std::vector<ConditionTrials> conditions{condition(1, 200, std::move(agents))};
  return agent_list(conditions);
}

}  // namespace

TEST_CASE("agents keep the colours, dashes and places that they registered", "[report]") {
  const json list = listed({agent("dqn", "dqn", {1.0}), agent("pretrained", "pretrained", {1.0}),
                            agent("constant-90", "constant", {1.0}), agent("planner", "planner", {1.0}),
                            agent("constant-120", "constant", {1.0}), agent("min-height", "min-height", {1.0})});
  std::vector<std::string> names;
  for (const json& one : list) names.push_back(one["name"]);
  CHECK(names == std::vector<std::string>{"min-height", "constant-120", "constant-90", "planner", "pretrained", "dqn"});
  CHECK(list[0]["colour"] == json({{"light", "#139fce"}, {"dark", "#0fbdff"}}));
  CHECK(list[1]["colour"]["light"] == "#8e1b4b");
  CHECK(list[1]["dash"] == json({8, 2, 2, 2, 2, 2}));
  CHECK(list[4]["colour"]["light"] == "#ba3c87");
  CHECK(list[5]["colour"]["light"] == "#d04500");
  CHECK(list[5]["dash"] == json({1, 0}));
}

TEST_CASE("an agent without a look has the colour that belongs to its name, unless another one here has it",
          "[report]") {
  const auto colour_of = [](const json& list, std::string_view name) {
    return std::ranges::find(list, json(name), [](const json& one) { return one["name"]; })->at("colour");
  };
  const json alone = listed({agent("one", "dqn", {1.0})});
  const json beside =
      listed({agent("two", "dqn", {1.0}), agent("planner", "planner", {1.0}), agent("one", "dqn", {1.0})});
  CHECK(colour_of(alone, "one") == json({{"light", "#8088ff"}, {"dark", "#748aae"}}));
  CHECK(colour_of(beside, "one") == colour_of(alone, "one"));
  CHECK(colour_of(beside, "two") != colour_of(alone, "one"));
}

TEST_CASE("24 agents of a report have 24 colours, and more agents other dashes", "[report]") {
  std::vector<AgentTrials> many{agent("planner", "planner", {1.0})};
  for (int i = 0; i < 47; ++i) many.push_back(agent("agent-" + std::to_string(i), "dqn", {1.0}));
  std::set<json> colours;
  std::set<json> looks;
  for (const json& one : listed(many)) {
    if (looks.size() < 24) CHECK(colours.insert(one["colour"]).second);
    CHECK(looks.insert(json{one["colour"], one["dash"]}).second);
  }
  CHECK(looks.size() == 48);
}

TEST_CASE("the 24 looks can be told apart and stand out, on light and on dark paper", "[report]") {
  const Eye red_green_eyes[] = {protanopia, deuteranopia};
  CHECK_THAT(distance(as_oklab(linear("#ff0000")), {0.62796, 0.22486, 0.12585}), Catch::WithinAbs(0.0, 1e-4));
  CHECK_THAT(contrast("#ffffff", "#000000"), Catch::WithinAbs(21.0, 1e-9));
  const std::vector<Look> looks = palette();
  REQUIRE(looks.size() == 24);
  for (const auto& [colour, paper] : {std::pair{&Look::light, "#ffffff"}, std::pair{&Look::dark, "#171c24"}})
    for (std::size_t i = 0; i < looks.size(); ++i) {
      CHECK(contrast(looks[i].*colour, paper) >= 3.0);  // WCAG 2.2, 1.4.11
      for (std::size_t k = 0; k < i; ++k) {
        INFO(looks[i].agent << ' ' << looks[i].*colour << ", " << looks[k].agent << ' ' << looks[k].*colour);
        const Linear one = linear(looks[i].*colour);
        const Linear other = linear(looks[k].*colour);
        const double apart = distance(as_oklab(one), as_oklab(other));
        CHECK(apart >= 0.1);
        bool alike = apart < 0.15;
        for (const Eye& eye : red_green_eyes)
          alike = alike || distance(as_oklab(seen_by(eye, one)), as_oklab(seen_by(eye, other))) < 0.1;
        if (alike) CHECK(looks[i].dash != looks[k].dash);
      }
    }
}

TEST_CASE("dashes are pairs of strokes and gaps", "[report]") {
  for (const Look& look : palette()) {
    CHECK(look.dash.size() % 2 == 0);
    CHECK_FALSE(look.dash.empty());
  }
}
