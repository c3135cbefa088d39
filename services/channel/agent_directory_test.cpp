#include "services/channel/agent_directory.hpp"

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include "common/base/error.hpp"

namespace aloft::channel {
namespace {

using agents::Privilege;
using Catch::Contains;

agents::AgentSpec spec_of(const nlohmann::json& entry) {
  return agents::parse_agents(entry, "test").front();
}

}  // namespace

TEST_CASE("our own agents see what their type declares, whatever a sample says") {
  CHECK(granted(spec_of("min-height"), wire::PRIVILEGE_WHOLE_ROUTE) == Privilege::none);
  CHECK(granted(spec_of("planner"), wire::PRIVILEGE_NONE) == Privilege::whole_route);
}

TEST_CASE("a foreign agent sees what it asks for, and no more than the experiment allows") {
  const auto visitor = spec_of({{"type", "external"}, {"name", "visitor"}, {"privilege", "next-step"}});
  CHECK(visitor.privilege() == Privilege::next_step);
  CHECK(granted(visitor, wire::PRIVILEGE_NONE) == Privilege::none);
  CHECK(granted(visitor, wire::PRIVILEGE_NEXT_STEP) == Privilege::next_step);
  CHECK_THROWS_WITH(granted(visitor, wire::PRIVILEGE_WHOLE_ROUTE),
                    Contains("'visitor' asks to see the whole route at every height") &&
                        Contains("allows it privilege \"next-step\"") && Contains("\"privilege\": \"whole-route\""));
  CHECK_THROWS_AS(granted(spec_of({{"type", "external"}, {"name", "visitor"}}), wire::PRIVILEGE_NEXT_STEP), InputError);
}

TEST_CASE("agents that a flight needs and that are not there are named; for a relay, members of its crew") {
  AgentDirectory directory;
  const auto relay = spec_of({{"type", "relay"},
                              {"name", "both"},
                              {"crew", {{{"agent", "min-height"}}, {{"agent", "constant-60"}, {"from_step", 3}}}}});
  CHECK(directory.absent(relay) == std::vector<std::string>{"min-height", "constant-60"});
  wire::AgentStatus status;
  status.agent(wire::name("min-height"));
  status.state(wire::AGENT_READY);
  directory.update(status, Clock::now());
  CHECK(directory.absent(relay) == std::vector<std::string>{"constant-60"});
  CHECK(directory.absent(spec_of("min-height")).empty());
  CHECK(directory.absent(spec_of("planner")) == std::vector<std::string>{"planner"});
}

}  // namespace aloft::channel
