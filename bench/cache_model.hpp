#pragma once

#include <cstddef>
#include <vector>

namespace bench {

/// A cache that keeps the lines that were used last. Real ones keep nearly those.
class CacheModel {
 public:
  /// `lines`: how many it holds, at least one; `addresses`: how many different lines there are.
  CacheModel(std::size_t lines, std::size_t addresses)
      : room_(lines), nowhere_(addresses), neighbours_(addresses + 1, {nowhere_, nowhere_}), held_(addresses, false) {}

  /// True if the line was in the cache. It is now.
  bool use(std::size_t address) {
    const bool hit = held_[address];
    if (hit) {
      unlink(address);
    } else if (room_ > 0) {
      --room_;
    } else {
      const std::size_t oldest = neighbours_[nowhere_].newer;
      unlink(oldest);
      held_[oldest] = false;
    }
    held_[address] = true;
    const std::size_t newest = neighbours_[nowhere_].older;
    neighbours_[address] = {newest, nowhere_};
    neighbours_[newest].newer = address;
    neighbours_[nowhere_].older = address;
    return hit;
  }

 private:
  /// The lines in the order of their use form a ring, with `nowhere_` between the newest and the oldest one.
  struct Neighbours {
    std::size_t older;
    std::size_t newer;
  };

  void unlink(std::size_t address) {
    const Neighbours at = neighbours_[address];
    neighbours_[at.older].newer = at.newer;
    neighbours_[at.newer].older = at.older;
  }

  std::size_t room_;
  std::size_t nowhere_;
  std::vector<Neighbours> neighbours_;
  std::vector<bool> held_;
};

}  // namespace bench
