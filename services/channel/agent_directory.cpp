#include "services/channel/agent_directory.hpp"

namespace aloft::channel {
namespace {

constexpr std::chrono::seconds silence_limit{3};

}  // namespace

bool AgentDirectory::update(const wire::AgentStatus& status, Clock::time_point now) {
  const std::string_view agent = wire::view(status.agent());
  const auto at = agents_.find(agent);
  if (status.state() == wire::AGENT_STOPPED) {
    if (at != agents_.end()) agents_.erase(at);
    return false;
  }
  const bool added = at == agents_.end();
  agents_.insert_or_assign(std::string(agent), Entry{status.privilege(), now});
  return added;
}

std::vector<std::string> AgentDirectory::expire(Clock::time_point now) {
  std::vector<std::string> gone;
  std::erase_if(agents_, [&](const auto& entry) {
    if (now - entry.second.seen <= silence_limit) return false;
    gone.push_back(entry.first);
    return true;
  });
  return gone;
}

const AgentDirectory::Entry* AgentDirectory::find(std::string_view agent) const {
  const auto at = agents_.find(agent);
  return at == agents_.end() ? nullptr : &at->second;
}

std::vector<std::string> AgentDirectory::names() const {
  std::vector<std::string> names;
  for (const auto& [name, entry] : agents_) names.push_back(name);
  return names;
}

}  // namespace aloft::channel
