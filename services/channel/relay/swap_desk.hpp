#pragma once

#include <map>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "common/bus/wire.hpp"
#include "common/experiment/experiment.hpp"
#include "services/channel/agent_directory.hpp"
#include "services/channel/episode.hpp"
#include "services/channel/relay/crew.hpp"

namespace aloft::channel {

/// Takes orders to swap agents, keeps them for the flights that start later, and knows how far the latest has come.
/// No bus: the caller asks and answers.
class SwapDesk {
 public:
  using Episodes = std::vector<std::unique_ptr<Episode>>;

  /// Handles a request once, however often it comes. Returns the episodes that have to ask another pilot.
  std::vector<Episode*> handle(const wire::SwapRequest& request, const experiment::Experiment& experiment,
                               const AgentDirectory& agents, const Episodes& episodes, Clock::time_point now);
  /// How the latest request fares.
  [[nodiscard]] wire::SwapReply& reply() noexcept { return reply_; }
  /// Counts again; true if something has changed.
  bool recount(const Episodes& episodes);
  /// Gives a new flight the order that stands for it.
  void brief(Episode& episode, Clock::time_point now) const;

 private:
  std::map<std::string, SwapOrder, std::less<>> orders_;  // by relay
  std::set<std::uint32_t> open_;                          // attempts that the latest request concerns
  wire::SwapReply reply_;
};

}  // namespace aloft::channel
