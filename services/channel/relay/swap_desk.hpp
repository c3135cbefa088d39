#pragma once

#include <map>
#include <set>
#include <string>
#include <vector>

#include "common/bus/wire.hpp"
#include "common/experiment/experiment.hpp"
#include "services/channel/agent_directory.hpp"
#include "services/channel/episode.hpp"
#include "services/channel/relay/crew.hpp"

namespace aloft::channel {

/// Takes orders to swap agents, keeps them for later flights, and counts the flights that the latest has reached.
/// No bus: the caller asks and answers.
class SwapDesk {
 public:
  using Episodes = std::vector<std::unique_ptr<Episode>>;

  /// Handles a request once, however often it comes. Returns the episodes that have to ask another pilot.
  std::vector<Episode*> handle(const wire::SwapRequest& request, const experiment::Experiment& experiment,
                               const AgentDirectory& agents, const Episodes& episodes, Clock::time_point now);
  /// The state of the latest request.
  [[nodiscard]] wire::SwapReply& reply() noexcept { return reply_; }
  /// Counts again; true if something has changed.
  bool recount(const Episodes& episodes);
  /// Gives a new flight the order that holds for it, if there is one.
  void brief(Episode& episode, Clock::time_point now) const;

 private:
  std::map<std::string, SwapOrder, std::less<>> orders_;  // by relay
  std::set<std::uint32_t> open_;                          // attempts that the latest request concerns
  wire::SwapReply reply_;
};

}  // namespace aloft::channel
