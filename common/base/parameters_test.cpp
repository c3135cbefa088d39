#include "common/base/parameters.hpp"

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
