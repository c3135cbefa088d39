#pragma once

#include <cstdint>
#include <memory>
#include <set>
#include <string>
#include <string_view>

#include "common/bus/endpoint.hpp"
#include "common/experiment/experiment.hpp"

namespace aloft::runtime {

/// What a process of a worker learns from RunControl: the experiment of its run, its collector, and when the run is
/// over. A process serves one experiment: messages about others are dropped, and so is one that cannot be read.
class RunFollower {
 public:
  explicit RunFollower(const bus::Participant& participant) : controls_(participant) {}

  /// Reads what has arrived. True once: when the experiment has become known.
  bool update();

  [[nodiscard]] bool over() const noexcept { return over_; }
  /// ProcessName::incarnation of the collector whose confirmations count; 0: not known yet.
  [[nodiscard]] std::uint64_t collector() const noexcept { return collector_; }
  /// Null until it is known.
  [[nodiscard]] const std::shared_ptr<const experiment::Experiment>& experiment() const noexcept { return experiment_; }
  /// For a waiter.
  [[nodiscard]] bus::Reader<wire::RunControl>& reader() noexcept { return controls_; }

 private:
  void follow(const wire::RunControl& control);
  /// Logs it once per sender, because a sender can repeat an unreadable experiment without end.
  void refuse(std::string_view reason);

  bus::Reader<wire::RunControl> controls_;
  std::shared_ptr<const experiment::Experiment> experiment_;
  std::set<std::string> refused_senders_;
  std::uint64_t collector_ = 0;
  bool over_ = false;
};

}  // namespace aloft::runtime
