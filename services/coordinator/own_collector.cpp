#include "services/coordinator/own_collector.hpp"

#include <algorithm>

namespace aloft::coordinator {

OwnCollector::Verdict OwnCollector::hear(const News& news, const Folder& folder, Clock::time_point now) {
  if (is_own(news.process)) {
    own_ = news;
    return Verdict::own;
  }
  const std::uint64_t incarnation = news.process.incarnation;
  if (std::ranges::find(refused_, incarnation) != refused_.end()) return Verdict::foreign;
  if (becomes_own(news, folder)) {
    own_ = news;
    return Verdict::now_own;
  }
  if (now - start_ < settling_time) return Verdict::foreign;
  if (refused_.size() == refusals_kept) refused_.erase(refused_.begin());
  refused_.push_back(incarnation);
  return Verdict::now_refused;
}

bool OwnCollector::becomes_own(const News& news, const Folder& folder) const {
  if (folder.has_database) return folder.signer && folder.signer->incarnation == news.process.incarnation;
  if (news.process.host == host_) return false;  // its database is on this machine, and not in our folder
  return !own_ || (own_->process.host == news.process.host && own_->results == news.results);
}

}  // namespace aloft::coordinator
