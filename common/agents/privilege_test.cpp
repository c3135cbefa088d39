#include "common/agents/privilege.hpp"

#include <algorithm>
#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "common/agents/registry.hpp"

using namespace aloft::agents;

TEST_CASE("the tiers ascend, and each has its own name and mark") {
  const auto tiers = privilege_tiers();
  for (std::size_t i = 0; i < tiers.size(); ++i) {
    CHECK(static_cast<std::size_t>(tiers[i].privilege) == i);
    CHECK(&privilege_tier(tiers[i].privilege) == &tiers[i]);
    CHECK(&privilege_tier(tiers[i].name) == &tiers[i]);
    CHECK(tiers[i].mark.empty() == (tiers[i].privilege == Privilege::none));
    for (std::size_t k = 0; k < i; ++k) CHECK(tiers[i].mark != tiers[k].mark);
  }
  CHECK_THROWS_AS(privilege_tier("all"), std::logic_error);
}

TEST_CASE("a mark follows the name, and is explained") {
  CHECK(marked("dqn", privilege_tier(Privilege::none)) == "dqn");
  CHECK(marked("one-step-ahead", privilege_tier(Privilege::next_step)) == "one-step-ahead *");
  CHECK(marked("planner", privilege_tier(Privilege::whole_route)) == "planner **");
  CHECK(marks_explained() ==
        "+ sees the site map and the route ahead, * sees the next step at every height, ** sees the whole route at "
        "every height");
}

TEST_CASE("privileged agents are flown by the process whose role reads what they are told in secured runs") {
  for (const AgentType& type : agent_types()) {
    INFO(type.name);
    CHECK((type.privilege == Privilege::none || type.hosted_by() == Host::baseline_agent));
  }
}

TEST_CASE("an agent has the privilege of its type, a relay the highest of its crew") {
  const auto of = [](const char* name) { return parse_agents(name, "").front(); };
  CHECK(of("min-height").privilege() == Privilege::none);
  CHECK(of("one-step-ahead").privilege() == Privilege::next_step);
  CHECK(of("planner").privilege() == Privilege::whole_route);
  const AgentSpec relay{"both", "relay", {}, {{of("min-height"), 1, true}, {of("planner"), 51, true}}};
  CHECK(relay.privilege() == Privilege::whole_route);
}
