#include "common/agents/relay.hpp"

#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <stdexcept>

#include "common/base/error.hpp"
#include "common/base/plain_text.hpp"

namespace aloft::agents {
namespace {

using Json = nlohmann::json;

AgentSpec one_agent(const Json& entry, const std::string& where) {
  std::vector<AgentSpec> specs = parse_agents(entry, where);
  if (specs.size() != 1)
    throw InputError("{}: {} is not allowed; a crew member is one agent, so give each parameter one value", where,
                     excerpt(entry.dump()));
  const AgentType& type = agent_type(specs.front().type);
  if (type.relay) throw InputError("{}: a relay cannot be part of a relay; list its crew here", where);
  if (foresees(specs.front().privilege()))
    throw InputError(
        "{}: agent '{}' is privileged: it would have to be shown quality that was not measured, in the "
        "middle of a flight; use agents that do not see the future (see aloft agents)",
        where, specs.front().name);
  if (specs.front().lineages() > 0)
    throw InputError(
        "{}: agent '{}' remembers earlier flights, which a crew member cannot; give it "
        "\"memory\": \"per-flight\"",
        where, specs.front().name);
  return std::move(specs.front());
}

CrewMember member(Json entry, const std::string& where) {
  if (!entry.is_object() || !entry.contains("agent"))
    throw InputError("{}: {} is not allowed; use an object with \"agent\" and, optional, \"from_step\" and \"shadow\"",
                     where, excerpt(entry.dump()));
  AgentSpec agent = one_agent(entry["agent"], where + ".agent");
  entry.erase("agent");
  const Parameters settings(crew_parameters(), entry, where);
  CrewMember result{std::move(agent), static_cast<std::uint32_t>(settings.integer("from_step")),
                    settings.flag("shadow")};
  if (result.shadow && agent_type(result.agent.type).foreign)
    throw InputError(
        "{}: agent '{}' is a program of your own, which receives only the reports that it must "
        "answer; give it \"shadow\": false",
        where, result.agent.name);
  return result;
}

}  // namespace

std::span<const ParameterSpec> crew_parameters() {
  static const std::vector<ParameterSpec> table{
      integer_parameter("from_step", 0, 0, 10'000,
                        "First step that it flies; 0: it stands by, and flies when it is swapped in or takes over."),
      flag_parameter("shadow", true, "Follow the flight from the start and learn from it; false: come aboard cold."),
  };
  return table;
}

std::vector<CrewMember> take_crew(Json& entry, bool named, std::string_view where) {
  const Json list = entry.value("crew", Json());
  if (!named || !list.is_array() || list.size() < 2 || list.size() > max_crew)
    throw InputError("{}: a relay needs a \"name\" and a \"crew\" of 2 to {} members, e.g. {}", where, max_crew,
                     R"({"type": "relay", "name": "dqn-relieves", "crew": [{"agent": "min-height"}, )"
                     R"({"agent": "dqn", "from_step": 51}]})");
  entry.erase("crew");
  std::vector<CrewMember> crew;
  std::uint32_t latest = 1;
  for (std::size_t i = 0; i < list.size(); ++i) {
    const std::string path = fmt::format("{}.crew[{}]", where, i);
    CrewMember next = member(list[i], path);
    if (i == 0) {
      if (next.from_step > 1)
        throw InputError("{}.from_step: {} is not allowed; the first member flies from step 1", path, next.from_step);
      next.from_step = 1;
    } else if (next.from_step > 0 && next.from_step <= latest) {
      throw InputError("{}.from_step: {} is not allowed; use more than the {} of an earlier member", path,
                       next.from_step, latest);
    }
    latest = std::max(latest, next.from_step);
    for (const CrewMember& other : crew)
      if (other.agent.name == next.agent.name)
        throw InputError("{}.agent: \"{}\" is in this crew already; give one of them another \"name\"", path,
                         next.agent.name);
    crew.push_back(std::move(next));
  }
  return crew;
}

Json crew_to_json(const std::vector<CrewMember>& crew) {
  Json list = Json::array();
  for (const CrewMember& one : crew)
    list.push_back({{"agent", one.agent.to_json()}, {"from_step", one.from_step}, {"shadow", one.shadow}});
  return list;
}

std::size_t written_pilot(const std::vector<CrewMember>& crew, std::uint32_t step) noexcept {
  std::size_t pilot = 0;
  for (std::size_t i = 0; i < crew.size(); ++i)
    if (crew[i].from_step > 0 && crew[i].from_step <= step) pilot = i;  // from_step ascends
  return pilot;
}

namespace {

std::unique_ptr<Agent> refuse_relay(const Parameters& /*parameters*/) {
  throw std::logic_error("a relay is flown by its crew");
}

const bool relay_registered =
    register_agent({.name = "relay",
                    .description = "Several agents share a flight: relieve each other, follow as shadows, take over.",
                    .relay = true,
                    .make = refuse_relay});

}  // namespace

}  // namespace aloft::agents
