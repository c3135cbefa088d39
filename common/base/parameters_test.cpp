#include "common/base/parameters.hpp"

#include <array>
#include <catch2/catch.hpp>
#include <limits>
#include <nlohmann/json.hpp>

#include "common/base/error.hpp"

using aloft::InputError;
using aloft::Parameters;
using Json = nlohmann::json;

namespace {

const std::vector<aloft::ParameterSpec> table{
    aloft::number_parameter("height_m", 120, 0, 1000, "Height to hold."),
    aloft::integer_parameter("layers", 3, 1, 8, "Hidden layers."),
    aloft::flag_parameter("target_network", true, "Use a target network."),
    aloft::choice_parameter("loss", "mse", {"mse", "cross-entropy"}, "What is minimised."),
};

std::string message_of(const Json& given) {
  try {
    const Parameters ignored(table, given, "agents[2]");
  } catch (const InputError& error) {
    return error.what();
  }
  return "accepted";
}

}  // namespace

TEST_CASE("the word of a choice is parsed by the table that allows it") {
  enum class Loss { mse, cross_entropy };
  constexpr std::array<aloft::Choice<Loss>, 2> losses{{{"mse", Loss::mse}, {"cross-entropy", Loss::cross_entropy}}};
  const std::vector specs{aloft::choice_parameter("loss", losses, "What is minimised.")};
  CHECK(specs[0].choices == std::vector<std::string>{"mse", "cross-entropy"});
  CHECK(Parameters(specs).chosen("loss", losses) == Loss::mse);
  CHECK(Parameters(specs, Json{{"loss", "cross-entropy"}}, "").chosen("loss", losses) == Loss::cross_entropy);
  constexpr std::array<aloft::Choice<Loss>, 1> fewer{{{"cross-entropy", Loss::cross_entropy}}};
  CHECK_THROWS_WITH(Parameters(specs).chosen("loss", fewer), "parameter 'loss' has the unknown value 'mse'");
}

TEST_CASE("an implied default is left out of the canonical form, and any other value is part of it") {
  std::vector<aloft::ParameterSpec> specs = table;
  specs[1].default_is_implied = true;
  CHECK_FALSE(Parameters(specs).to_json().contains("layers"));
  CHECK_FALSE(Parameters(specs, Json{{"layers", 3}}, "").to_json().contains("layers"));
  CHECK(Parameters(specs, Json{{"layers", 3}}, "").integer("layers") == 3);
  CHECK(Parameters(specs, Json{{"layers", 4}}, "").to_json().at("layers") == 4);
}

TEST_CASE("defaults are filled in and overrides applied") {
  const Parameters parameters(table, Json{{"loss", "cross-entropy"}, {"height_m", 60}}, "agents[0]");
  CHECK(parameters.number("height_m") == 60);
  CHECK(parameters.integer("layers") == 3);
  CHECK(parameters.flag("target_network"));
  CHECK(parameters.text("loss") == "cross-entropy");
  CHECK(parameters.to_json().dump() == R"({"height_m":60,"layers":3,"loss":"cross-entropy","target_network":true})");
}

TEST_CASE("a bad value is refused with path, value and allowed range") {
  CHECK(message_of({{"height_m", -1}}) == "agents[2].height_m: -1 is not allowed; use a number from 0 to 1000");
  CHECK(message_of({{"height_m", "60"}}) == "agents[2].height_m: \"60\" is not allowed; use a number from 0 to 1000");
  CHECK(message_of({{"layers", 2.5}}) == "agents[2].layers: 2.5 is not allowed; use a whole number from 1 to 8");
  CHECK(message_of({{"loss", "mae"}}) ==
        "agents[2].loss: \"mae\" is not allowed; use one of \"mse\", \"cross-entropy\"");
  CHECK(message_of({{"target_network", 1}}) == "agents[2].target_network: 1 is not allowed; use true or false");
  CHECK(message_of({{"height_m", std::numeric_limits<double>::quiet_NaN()}}) != "accepted");
  CHECK(message_of({{"heigth_m", 60}}) ==
        "agents[2].heigth_m: unknown key. Did you mean 'height_m'? Valid keys: height_m, layers, target_network, loss");
  CHECK(message_of(Json::array()) == "agents[2]: [] is not allowed; use an object of parameters");
}

TEST_CASE("the schema of a table carries its ranges") {
  const Json schema = aloft::schema_properties(table);
  CHECK(schema["height_m"]["maximum"] == 1000);
  CHECK(schema["layers"]["type"] == "integer");
  CHECK(schema["loss"]["enum"] == Json{"mse", "cross-entropy"});
}
