#include "services/channel/missing_peers.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <spdlog/spdlog.h>

#include <algorithm>

#include "common/base/seconds.hpp"

namespace aloft::channel {
namespace {

/// "agents dqn, planner (no command for 4 s)".
std::string silence_text(const std::map<std::string, Clock::duration>& silent) {
  std::vector<std::string> names;
  Clock::duration longest{};
  for (const auto& [name, silence] : silent) {
    names.push_back(name);
    longest = std::max(longest, silence);
  }
  return fmt::format("{} (no command for {:.0f} s)", agents_text(names), seconds(longest));
}

/// The text up to its first number, which grows while the same peers are missing.
std::string first_name(const std::string& text) {
  return text.substr(0, text.find('('));
}

}  // namespace

std::string agents_text(const std::vector<std::string>& names) {
  return fmt::format("agent{} {}", names.size() == 1 ? "" : "s", fmt::join(names, ", "));
}

void MissingPeers::update(const Facts& facts, Clock::time_point now) {
  std::vector<std::string> peers;
  if (!facts.silent_agents.empty()) peers.push_back(silence_text(facts.silent_agents));
  if (!facts.absent_agents.empty()) peers.push_back(fmt::format("{} (not there)", agents_text(facts.absent_agents)));
  if (facts.collector_silence > patience)
    peers.push_back(fmt::format("the collector ({} records unconfirmed)", facts.records_unconfirmed));
  if (facts.environment_there) environment_seen_ = now;
  if (now - environment_seen_ > patience) peers.emplace_back("the environment (not there)");
  std::string text = fmt::format("{}", fmt::join(peers, ", "));
  const bool others = first_name(text) != first_name(text_);
  text_ = std::move(text);
  if (others) text_.empty() ? spdlog::info("no peer is missing any more") : spdlog::warn("waits for {}", text_);
}

}  // namespace aloft::channel
