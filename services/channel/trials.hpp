#pragma once

#include <cstdint>
#include <deque>
#include <list>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include "common/radio/signal_map.hpp"

namespace aloft::channel {

/// One leased trial, from its world to the confirmation of its last record.
struct Trial {
  std::uint64_t lease_id = 0;
  std::uint32_t condition = 0;
  std::uint32_t trial = 0;
  std::vector<std::string> waiting;       ///< agents whose flight has not started
  std::set<std::uint64_t> unconfirmed;    ///< episodes that are flown, but not stored
  std::unique_ptr<radio::SignalMap> map;  ///< null until it is built, and again after the last flight
  std::uint32_t in_the_air = 0;           ///< flights
  int lane = -1;                          ///< -1: none yet, or given back

  [[nodiscard]] bool flown() const noexcept { return waiting.empty() && in_the_air == 0; }
};

/// The trials of a worker, oldest lease first, and the lanes they fly in: at most one trial per lane.
class Trials {
 public:
  explicit Trials(std::uint32_t lanes) : lane_taken_(lanes, false) {}

  Trial& add(std::uint64_t lease_id, std::uint32_t condition, std::uint32_t trial, std::vector<std::string> agents);
  /// Null if the lease is not held.
  [[nodiscard]] Trial* find(std::uint64_t lease_id);
  void remove(std::uint64_t lease_id);
  /// True if the lease is held, or was not long ago: its assignment may come again from a restarted environment.
  [[nodiscard]] bool knows(std::uint64_t lease_id) const;
  /// Gives the trial a lane; false if none is free.
  bool take_lane(Trial& trial);
  /// The last flight has landed: lane and map are free again.
  void give_back(Trial& trial);

  [[nodiscard]] std::list<Trial>& all() noexcept { return trials_; }
  [[nodiscard]] const std::list<Trial>& all() const noexcept { return trials_; }
  /// Trials that are flown and wait for their records to be stored.
  [[nodiscard]] std::size_t waiting_for_storage() const;
  [[nodiscard]] std::uint32_t lanes() const noexcept { return static_cast<std::uint32_t>(lane_taken_.size()); }

 private:
  std::list<Trial> trials_;
  std::deque<std::uint64_t> past_;  // leases, the latest first
  std::vector<bool> lane_taken_;
};

}  // namespace aloft::channel
