#include "common/agents/registry.hpp"

#include <algorithm>
#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include "common/base/error.hpp"

using namespace aloft;
using namespace aloft::agents;
using Catch::Contains;

namespace {

std::vector<std::string> names(const nlohmann::json& entry) {
  std::vector<std::string> result;
  for (const AgentSpec& spec : parse_agents(entry, "agents[2]")) result.push_back(spec.name);
  return result;
}

using Names = std::vector<std::string>;
using Json = nlohmann::json;

/// A type for these tests only.
const bool registered = register_agent(
    {.name = "sample",
     .description = "For tests.",
     .name_parameter = "gain_db",
     .parameters = {number_parameter("gain_db", 0, -10, 10, "Gain."), flag_parameter("loud", false, "Loud."),
                    choice_parameter("loss", "mse", {"mse", "Cross_Entropy"}, "Loss.")}});

}  // namespace

TEST_CASE("registered types are listed in order of their names") {
  REQUIRE(registered);
  const auto types = agent_types();
  CHECK(std::is_sorted(types.begin(), types.end(), [](const auto& a, const auto& b) { return a.name < b.name; }));
  CHECK(agent_type("min-height").privilege == Privilege::none);
  CHECK_THROWS_AS(register_agent({.name = "sample"}), std::logic_error);
}

TEST_CASE("every type has a usable name, a sentence, and parameters within their own ranges") {
  for (const AgentType& type : agent_types()) {
    INFO(type.name);
    CHECK(type.name.find_first_not_of("abcdefghijklmnopqrstuvwxyz0123456789-") == std::string::npos);
    CHECK(type.description.ends_with('.'));
    CHECK_NOTHROW(Parameters(type.parameters, Parameters(type.parameters).to_json(), type.name));
    const auto has_name_parameter = std::any_of(type.parameters.begin(), type.parameters.end(),
                                                [&](const auto& p) { return p.name == type.name_parameter; });
    CHECK(has_name_parameter == !type.name_parameter.empty());
  }
}

TEST_CASE("an entry is a name, a short form, or an object") {
  CHECK(names("sample") == Names{"sample"});
  CHECK(names("sample-3.5") == Names{"sample-3.5"});
  CHECK(parse_agents("sample-3.5", "").front().parameters.number("gain_db") == 3.5);
  CHECK(names({{"type", "sample"}}) == Names{"sample"});
  CHECK(names({{"type", "sample"}, {"gain_db", 4}}) == Names{"sample-4"});
  CHECK(names({{"type", "sample"}, {"loud", true}}) == Names{"sample"});
  CHECK(names({{"type", "sample"}, {"name", "mine"}, {"gain_db", 4}}) == Names{"mine"});
}

TEST_CASE("a list makes one agent per value, several lists one per combination") {
  CHECK(names({{"type", "sample"}, {"gain_db", {-1, 2}}}) == Names{"sample--1", "sample-2"});
  CHECK(names({{"type", "sample"}, {"name", "x"}, {"loss", {"mse", "Cross_Entropy"}}}) ==
        Names{"x-mse", "x-cross-entropy"});
  CHECK(names({{"type", "sample"}, {"gain_db", {1, 2}}, {"loud", {true, false}}}) ==
        Names{"sample-1-true", "sample-1-false", "sample-2-true", "sample-2-false"});
  const auto specs = parse_agents({{"type", "sample"}, {"gain_db", {1, 2}}}, "");
  CHECK(specs[1].parameters.number("gain_db") == 2);
  CHECK(specs[1].type == "sample");
}

TEST_CASE("wrong entries are refused with the reason and the nearest valid name") {
  const auto reason = [](const Json& entry) {
    try {
      (void)parse_agents(entry, "agents[2]");
    } catch (const InputError& error) {
      return std::string(error.what());
    }
    return std::string("accepted");
  };
  CHECK_THAT(reason("min-hight"), Contains("agents[2]: unknown agent 'min-hight'. Did you mean 'min-height'?"));
  CHECK_THAT(reason({{"type", "smaple"}}), Contains("agents[2].type: unknown agent 'smaple'. Did you mean 'sample'?"));
  CHECK_THAT(reason("sample-loud"), Contains("after \"sample-\" write a number for gain_db"));
  CHECK_THAT(reason("sample-11"), Contains("agents[2].gain_db: 11.0 is not allowed; use a number from -10 to 10"));
  CHECK_THAT(reason({{"type", "sample"}, {"gian_db", 1}}),
             Contains("agents[2].gian_db: unknown key. Did you mean 'gain_db'?"));
  CHECK_THAT(reason({{"type", "sample"}, {"gain_db", Json::array()}}), Contains("list at least one value"));
  CHECK_THAT(reason(7), Contains("agents[2]: 7 is not allowed"));
  CHECK_THAT(reason(Json::object()), Contains("an object with \"type\""));
  CHECK_THAT(reason({{"type", 3}}), Contains("agents[2].type: 3 is not allowed; use a text"));
  CHECK_THAT(reason({{"type", "sample"}, {"name", "Mine!"}}), Contains("use 1 to 64 characters"));
  CHECK_THAT(reason({{"type", "sample"}, {"name", ""}, {"gain_db", {1, 2}}}), Contains("use 1 to 64 characters"));
  CHECK_THAT(reason({{"type", "sample"}, {"name", std::string(65, 'a')}}), Contains("use 1 to 64 characters"));
  CHECK_THAT(reason({{"type", "sample"}, {"name", "min-height"}}), Contains("the name of another type"));
  CHECK_THROWS_WITH(agent_type("sampel"), Contains("Did you mean 'sample'?"));
}

TEST_CASE("an external agent needs a name and cannot be made in this process") {
  CHECK_THROWS_WITH(parse_agents("external", "agents[0]"), Contains("needs \"name\""));
  const auto spec = parse_agents({{"type", "external"}, {"name", "my-agent"}}, "agents[0]").front();
  CHECK(spec.name == "my-agent");
  CHECK_THROWS_WITH(spec.make(), Contains("run over DDS"));
}
