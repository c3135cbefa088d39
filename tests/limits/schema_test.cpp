// The JSON Schema, which editors use, and the programs' own checks accept and refuse the same experiment files. The
// test changes accepted files in one place and compares both verdicts.
#include "common/experiment/schema.hpp"

#include <rapidcheck.h>

#include <algorithm>
#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>
#include <optional>
#include <regex>
#include <string>
#include <vector>

#include "common/base/error.hpp"
#include "common/base/random.hpp"
#include "common/experiment/experiment.hpp"
#include "common/experiment/testing/schema_validator.hpp"
#include "common/radio/models/link_model.hpp"
#include "tests/integration/command.hpp"
#include "tests/limits/random_experiment.hpp"

namespace aloft {
namespace {

using Json = nlohmann::json;
using Pointer = Json::json_pointer;

/// The parameters of a world depend on its channel model. This second model is registered to test that, not to fly.
const bool other_model_registered =
    radio::register_link_model({.name = "other-model",
                                .description = "For this test.",
                                .parameters = {number_parameter("other_loss_db", 20.0, 0.0, 60.0, "For this test.")}});

/// Messages of the checks for rules that a schema cannot express. Only for these may the verdicts differ.
bool no_schema_can_say(const std::string& message) {
  static const std::vector<std::regex> rules{
      // heights, route and base stations of one world against each other
      std::regex("height_m(ax|in)_m: .* is below|is no multiple of|does not divide|makes more than .* heights"),
      std::regex("leaves the city|is more than half of window_m|is too few for .* candidates|only one in .* cities "
                 "has|than a hexagonal grid|three cells need|three at each of"),
      std::regex("qin_db: .* is below qout_db"),
      // worlds that a channel model does not cover
      std::regex("is not the .* m of|is above the range of|is defined (from|up to)"),
      // names that are used twice, take too many bytes, or hold control characters
      std::regex(
          "stands already at|are both named|is in this crew already|is not the agent that has this name elsewhere"),
      std::regex("is the name of another type|agent name .* is not allowed; use 1 to|printable and on one line"),
      // parameters of one agent against each other
      std::regex("replay_capacity .* is smaller than minibatch|memory 'lifelong' would carry"),
      // agents that only another program knows
      std::regex("unknown agent|write a number for"),
      // agents together with worlds and with other agents
      std::regex(
          "plans the whole route|needs the site map|looks at .* neighbour cells|would fly from step|would never fly"),
      std::regex("needs an agent that can take over|cannot be part of a relay|would have to be shown quality"),
      std::regex("which a crew member cannot|receives only the reports that it must answer|a crew member is one agent"),
      std::regex("the first member flies from step 1|use more than the .* of an earlier member"),
      // products of lists
      std::regex("combinations, but|the sweep has more than|are too many; use at most|bytes when resolved"),
      // keys that only resolved experiments have
      std::regex("swept: .* it stands only in resolved experiments"),
      // named files and their content
      std::regex("\\.(sites_)?file: |cannot read"),
      // JSON Schema does not distinguish 5.0 from 5; only the second form can hold a seed of 64 bits
      std::regex("seed: -?[0-9]+[.e][0-9.e+]* is not allowed"),
  };
  return std::any_of(rules.begin(), rules.end(),
                     [&](const std::regex& rule) { return std::regex_search(message, rule); });
}

std::optional<std::string> refusal_by_checks(const Json& document) {
  try {
    (void)experiment::parse(document.dump(), "it");
  } catch (const InputError& error) {
    return error.what();
  }
  return std::nullopt;
}

class Mutations {
 public:
  explicit Mutations(std::uint64_t seed) : random_(seed, 0, "mutations") {}

  bool chance(double probability) { return random_.uniform() < probability; }
  template <class T>
  const T& one_of(const std::vector<T>& values) {
    return values[random_.uniform_index(static_cast<std::uint32_t>(values.size()))];
  }

  /// Forms of experiments that are not drawn at random.
  void enrich(Json& file) {
    if (chance(0.3)) file["$schema"] = "experiment.schema.json";
    if (chance(0.3)) file["build"] = "0.1.0";
    if (chance(0.3)) file["description"] = "text";
    Json& world = file["world"];
    if (chance(0.3)) world["name"] = "Feld bei Köln";
    if (chance(0.3)) world["propagation"] = one_of<Json>({"power-law", "other-model", {"power-law", "other-model"}});
    if (chance(0.3)) world["serving"] = one_of<Json>({"strongest", "a3", {"strongest", "a3"}});
    if (chance(0.5)) list_a_value(world);
    for (Json& agent : file["agents"])
      if (chance(0.3)) list_a_value(agent);
    if (chance(0.3)) file["agents"].push_back("constant-120");
    if (chance(0.3)) file["agents"].push_back({{"type", "external"}, {"name", "mine"}});
    if (chance(0.4)) {
      const Json constant{{"type", "constant"}, {"name", "constant-60.5"}, {"height_m", 60.5}};
      file["agents"].push_back({{"type", "relay"}, {"name", "crew"}, {"crew", Json::array()}});
      file["agents"].back()["crew"] = {{{"agent", "min-height"}, {"shadow", true}},
                                       {{"agent", constant}, {"from_step", 2}}};
    }
    if (chance(0.1)) file["on_agent_loss"] = "failover";
    if (chance(0.4)) {
      file["worlds"] = Json::array({file["world"]});
      file.erase("world");
    }
  }

  /// Changes one place of the file.
  void mutate(Json& file) {
    std::vector<Pointer> places;
    collect(file, Pointer(), places);
    const Pointer place = one_of(places);
    Json& value = file[place];
    const auto kind = random_.uniform_index(8);
    if (kind == 0 && !place.empty()) return remove(file, place);
    if (kind == 1 && value.is_object()) return add_key(value);
    if (kind == 2 && value.is_array())
      return value.push_back(value.empty() || chance(0.3) ? strange_value() : one_element(value));
    if (kind == 3) return void(value = Json::array({value}));
    if (kind == 4) return void(value = Json::array({value, strange_value()}));
    if (kind <= 6 && value.is_number()) return void(value = other_number(value));
    value = strange_value();
  }

 private:
  static void collect(const Json& value, const Pointer& place, std::vector<Pointer>& places) {
    places.push_back(place);
    if (value.is_array())
      for (std::size_t i = 0; i < value.size(); ++i) collect(value[i], place / i, places);
    if (value.is_object())
      for (const auto& [key, entry] : value.items()) collect(entry, place / key, places);
  }

  static void collect_words(const Json& schema, std::vector<std::string>& keys, std::vector<std::string>& choices) {
    if (schema.is_object() && schema.contains("properties") && schema["properties"].is_object())
      for (const auto& [key, unused] : schema["properties"].items()) keys.push_back(key);
    if (schema.is_object() && schema.contains("enum"))
      choices.insert(choices.end(), schema["enum"].begin(), schema["enum"].end());
    if (schema.is_structured())
      for (const Json& part : schema) collect_words(part, keys, choices);
  }

  struct Words {
    std::vector<std::string> keys{"unknown", "", "Trials"};
    std::vector<std::string> choices{"",    "x",          "a b",      "ä",        "min-height", "constant-60",
                                     "dqn", "constant-x", "measured", "generated"};
  };
  static const Words& words() {
    static const Words all = [] {
      Words words;
      collect_words(experiment::experiment_schema(), words.keys, words.choices);
      return words;
    }();
    return all;
  }

  /// Replaces a value by a list of this value: the same experiment, written as a sweep.
  void list_a_value(Json& object) {
    std::vector<std::string> keys;
    if (object.is_object())
      for (const auto& [key, value] : object.items())
        if (key != "kind" && key != "name" && key != "type") keys.push_back(key);
    if (keys.empty()) return;
    Json& value = object[one_of(keys)];
    value = Json::array({value});
  }

  static void remove(Json& file, const Pointer& place) {
    Json& parent = file[place.parent_pointer()];
    if (parent.is_array()) parent.erase(static_cast<std::size_t>(std::stoul(place.back())));
    if (parent.is_object()) parent.erase(place.back());
  }

  void add_key(Json& object) { object[one_of(words().keys)] = strange_value(); }

  const Json& one_element(const Json& list) {
    return list[random_.uniform_index(static_cast<std::uint32_t>(list.size()))];
  }

  Json other_number(const Json& value) {
    static const std::vector<double> factors{-1, 0, 0.5, 2, 1000, 1e9, 1e-9};
    if (chance(0.2)) return value.get<double>();  // the same, written as 5.0
    if (chance(0.2)) return value.get<double>() + 0.5;
    if (chance(0.5) && value.is_number_integer())
      return static_cast<std::int64_t>(value.get<double>() * 0.5 * one_of(factors));
    return value.get<double>() * one_of(factors);
  }

  Json strange_value() {
    static const std::vector<Json> values{nullptr,
                                          true,
                                          false,
                                          0,
                                          1,
                                          2,
                                          -1,
                                          0.5,
                                          3.0,
                                          1e3,
                                          -0.0,
                                          1e300,
                                          -1e300,
                                          INT64_MAX,
                                          INT64_MIN,
                                          UINT64_MAX,
                                          0x1p63,
                                          0x1p64,
                                          Json::array(),
                                          Json::object(),
                                          Json::array({1}),
                                          Json::array({1, 1}),
                                          Json::array({1, 1.0}),
                                          Json::array({Json::array()}),
                                          Json{{"x", 1}},
                                          std::string(64, 'a'),
                                          std::string(65, 'a'),
                                          std::string(200, 'a'),
                                          std::string(201, 'a'),
                                          "two\nlines"};
    return chance(0.4) ? Json(one_of(words().choices)) : one_of(values);
  }

  RandomStream random_;
};

}  // namespace

TEST_CASE("the schema and the checks accept and refuse the same files") {
  const test::ScratchDir scratch;
  int accepted = 0;
  int refused_by_both = 0;
  int refused_by_checks = 0;
  const auto both_accept = [&](const Json& file) {
    const std::vector<std::string> by_schema = experiment::schema_errors(file);
    const std::optional<std::string> by_checks = refusal_by_checks(file);
    if (!by_schema.empty() && !by_checks) RC_FAIL("only the schema refuses " + file.dump() + ": " + by_schema.front());
    if (by_schema.empty() && by_checks && !no_schema_can_say(*by_checks))
      RC_FAIL("only the checks refuse " + file.dump() + ": " + *by_checks);
    ++(!by_checks ? accepted : by_schema.empty() ? refused_by_checks : refused_by_both);
    return !by_checks;
  };
  const bool same = rc::check([&] {
    const auto seed = *rc::gen::noShrink(rc::gen::resize(rc::kNominalSize, rc::gen::arbitrary<std::uint64_t>()));
    Mutations mutations(seed);
    Json base = test::random_experiment(seed, scratch.path(), true).json;
    mutations.enrich(base);
    if (!both_accept(base)) return;
    if (mutations.chance(0.3)) base = experiment::parse(base.dump(), "it").canonical;
    for (int i = 0; i < 60; ++i) {
      Json file = base;
      mutations.mutate(file);
      both_accept(file);
    }
  });
  CHECK(same);
  CHECK(accepted > 200);
  CHECK(refused_by_both > 1000);
  CHECK(refused_by_checks > 100);
}

}  // namespace aloft
