#pragma once

// A guard before the middleware, in every run. Fast DDS as Debian packages it (2.9.1, 3.1.2) has known faults that one
// datagram triggers before any authentication. So it sees no datagram that was not checked: docs/vulnerabilities.md.

#include <array>
#include <atomic>
#include <memory>
#include <mutex>
#include <span>
#include <string>
#include <unordered_set>

#include "common/bus/guard/sender_limits.hpp"
#include "common/bus/middleware/receiving_transport.hpp"

namespace aloft::bus::guard {

/// Decides on each datagram that arrives, and counts what it refuses; from any thread. Logs the first refusal of each
/// address.
class DatagramGuard {
 public:
  /// `relayed`: see SenderLimits.
  explicit DatagramGuard(bool relayed) : limits_(relayed) {}

  /// `address`: of the sender, as a number.
  [[nodiscard]] bool admit(std::span<const unsigned char> datagram, std::uint32_t address);
  [[nodiscard]] RefusalCounts refused() const noexcept;

 private:
  void refuse(Refusal reason, std::uint32_t address);

  std::mutex mutex_;
  SenderLimits limits_;
  std::unordered_set<std::uint32_t> told_;
  std::array<std::atomic<std::uint64_t>, refusal_names.size()> refused_{};
};

/// `below`, with the guard before it.
[[nodiscard]] Transport guarded(std::shared_ptr<DatagramGuard> guard, Transport below);

}  // namespace aloft::bus::guard
