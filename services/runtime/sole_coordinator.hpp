#pragma once

#include <chrono>
#include <functional>
#include <optional>
#include <string>

#include "common/base/process_name.hpp"
#include "common/bus/endpoint.hpp"
#include "services/runtime/run_claim.hpp"

namespace aloft::runtime {

/// Ensures that a run has one coordinator: two would give every trial to two workers. On one machine a claim decides
/// which one is first; across machines, the samples of RunControl.
class SoleCoordinator {
 public:
  explicit SoleCoordinator(const bus::Participant& participant);

  /// Returns true once no other coordinator was heard for `quiet` and the claim is ours, false if it is `stopped`
  /// before. InputError, naming the other coordinator, if there is one: a coordinator that is there when we start was
  /// first.
  bool take(RunClaim& claim, std::chrono::milliseconds quiet, const std::function<bool()>& stopped);

  /// Another coordinator that runs this run, if one was heard since the last call.
  [[nodiscard]] std::optional<ProcessName> hear();
  /// For two that have started without hearing each other: true if `self` stays, false if it has to end.
  [[nodiscard]] static bool is_first(const ProcessName& self, const ProcessName& other) noexcept;
  /// Why there must be no second coordinator beside this one.
  [[nodiscard]] std::string refusal(const ProcessName& first) const;
  /// For a waiter.
  [[nodiscard]] bus::Reader<wire::RunControl>& reader() noexcept { return controls_; }

 private:
  std::string run_;
  bus::Reader<wire::RunControl> controls_;
};

}  // namespace aloft::runtime
