#include "services/channel/agent_directory.hpp"

#include "common/base/error.hpp"
#include "common/base/limits.hpp"
#include "common/base/seconds.hpp"
#include "common/bus/convert.hpp"

namespace aloft::channel {
namespace {

constexpr std::chrono::seconds silence_limit{3};
constexpr std::chrono::seconds absence_limit{3};

}  // namespace

agents::Privilege granted(const agents::AgentSpec& spec, wire::Privilege asked_for) {
  const agents::Privilege allowed = spec.privilege();
  if (!agents::agent_type(spec.type).foreign) return allowed;
  const agents::Privilege asked = bus::from_wire(asked_for);
  if (asked <= allowed) return asked;
  const agents::PrivilegeTier& tier = agents::privilege_tier(asked);
  throw InputError(
      "agent '{}' asks to see {}, but the experiment allows it privilege \"{}\"; give its entry "
      "\"privilege\": \"{}\", or let the program ask for less in AgentStatus",
      spec.name, tier.sees, agents::privilege_tier(allowed).name, tier.name);
}

bool AgentDirectory::update(const wire::AgentStatus& status, Clock::time_point now) {
  const std::string_view agent = wire::view(status.agent());
  const auto at = agents_.find(agent);
  if (status.state() == wire::AGENT_STOPPED) {
    if (at != agents_.end()) agents_.erase(at);
    return false;
  }
  const bool added = at == agents_.end() || at->second.lost;
  Entry entry{status.privilege(), now, {}, false};
  entry.news.agent(status.agent());
  entry.news.type(status.type());
  entry.news.process(status.process());
  entry.news.state(status.state());
  entry.news.flights(status.flights());
  agents_.insert_or_assign(std::string(agent), std::move(entry));
  missed_.erase(std::string(agent));
  return added;
}

std::map<std::string, std::vector<std::string>> AgentDirectory::expire(Clock::time_point now) {
  std::map<std::string, std::vector<std::string>> gone;
  for (auto& [name, entry] : agents_) {
    if (entry.lost || now - entry.seen <= silence_limit) continue;
    entry.lost = true;
    gone[std::string(wire::view(entry.news.process()))].push_back(name);
  }
  return gone;
}

void AgentDirectory::miss(std::string_view agent, Clock::time_point now) {
  missed_.try_emplace(std::string(agent), now);
}

bool AgentDirectory::waited_long(std::string_view agent, Clock::time_point now) const {
  const auto since = missed_.find(agent);
  return since != missed_.end() && now - since->second > absence_limit;
}

const AgentDirectory::Entry* AgentDirectory::find(std::string_view agent) const {
  const auto at = agents_.find(agent);
  return at == agents_.end() || at->second.lost ? nullptr : &at->second;
}

std::vector<std::string> AgentDirectory::absent(const agents::AgentSpec& spec) const {
  std::vector<std::string> names;
  const auto look_for = [&](const std::string& name) {
    if (find(name) == nullptr) names.push_back(name);
  };
  if (spec.crew.empty()) look_for(spec.name);
  for (const agents::CrewMember& member : spec.crew) look_for(member.agent.name);
  return names;
}

std::vector<wire::AgentNews> AgentDirectory::news(Clock::time_point now) const {
  std::vector<wire::AgentNews> all;
  for (const auto& [name, entry] : agents_) {
    if (all.size() == limits::agents_told) break;
    all.push_back(entry.news);
    all.back().silent_s(seconds(now - entry.seen));
  }
  return all;
}

}  // namespace aloft::channel
