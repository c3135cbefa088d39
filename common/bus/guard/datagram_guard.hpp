#pragma once

// A guard before the middleware, in every run. Fast DDS as Debian packages it (2.9.1, 3.1.2) has known faults that one
// datagram triggers before any authentication. So it sees no datagram that was not checked: docs/vulnerabilities.md.

#include <array>
#include <atomic>
#include <functional>
#include <memory>
#include <mutex>
#include <span>
#include <string>
#include <unordered_set>
#include <utility>

#include "common/bus/guard/sender_limits.hpp"
#include "common/bus/middleware/receiving_transport.hpp"

namespace aloft::bus::guard {

/// Decides on each datagram that arrives, and counts what it refuses; from any thread. Logs the first refusal of each
/// address.
class DatagramGuard {
 public:
  /// `relayed`: see SenderLimits. `left` is told each participant that says that it leaves, from any thread.
  DatagramGuard(bool relayed, std::function<void(const Prefix&)> left) : limits_(relayed), left_(std::move(left)) {}

  /// True if the middleware is to get it. `address`: of the sender, as a number.
  ///
  /// Fault of Fast DDS: the farewell of a participant that arrives in the microseconds in which the end of its lease is
  /// checked makes an assertion fail (PDP::check_remote_participant_liveliness), which ends the process. It happens by
  /// chance, and can be timed. Upstream: no issue is known; 2.9.1 and 3.1.2 have it. So the middleware gets no
  /// farewells: what has left is forgotten when its lease ends, its readers and writers at once, as it says of each.
  /// Not with a discovery server, whose clients know no lease but the server's. Can go when "participants that leave
  /// when their lease ends" (tests/faults/guard_test.cpp) passes without it.
  [[nodiscard]] bool admit(std::span<const unsigned char> datagram, std::uint32_t address);
  [[nodiscard]] RefusalCounts refused() const noexcept;

 private:
  void refuse(Refusal reason, std::uint32_t address);

  std::mutex mutex_;
  SenderLimits limits_;
  std::function<void(const Prefix&)> left_;
  std::unordered_set<std::uint32_t> told_;
  std::array<std::atomic<std::uint64_t>, refusal_names.size()> refused_{};
};

/// `below`, with the guard before it.
[[nodiscard]] Transport guarded(std::shared_ptr<DatagramGuard> guard, Transport below);

}  // namespace aloft::bus::guard
