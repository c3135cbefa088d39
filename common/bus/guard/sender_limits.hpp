#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <unordered_map>
#include <vector>

#include "common/bus/guard/datagram_check.hpp"

namespace aloft::bus::guard {

/// Weighs what datagrams claim against what their senders, or the addresses that they come from, claimed before. It
/// remembers a bounded number of senders, and gets the clock passed in. All limits are far above what a run needs.
class SenderLimits {
 public:
  using Clock = std::chrono::steady_clock;

  /// Hosts have ports for 120 participants of a domain; all of them may have been killed and started again before the
  /// old ones are forgotten. The middleware takes about 26 KB for each.
  static constexpr std::size_t participants_per_address = 256;
  static constexpr std::size_t max_participants = 4096;
  /// From an address, of senders that have not announced themselves: at once, and for each second.
  static constexpr double unannounced_at_once = 4096;
  static constexpr double unannounced_per_s = 1024;
  /// Of a sender: samples that have begun to arrive in fragments. A writer sends one after the other.
  static constexpr std::size_t max_pending = 256;
  static constexpr std::size_t max_pending_bytes = 256U << 20U;

  /// `relayed`: a discovery server passes on the announcements of all participants, from its own address, and the
  /// middleware hears of it when one leaves. Otherwise it remembers each until its lease ends (DatagramGuard::admit).
  explicit SenderLimits(bool relayed) : relayed_(relayed) {}

  /// Whether a datagram from `address`, which passed check_datagram, is within the limits: Refusal::none, and its
  /// claims are remembered; or participants, pending, gap or rate.
  [[nodiscard]] Refusal admit(std::uint32_t address, const Claims& claims, Clock::time_point now);

  [[nodiscard]] bool relayed() const noexcept { return relayed_; }
  [[nodiscard]] std::size_t participants() const noexcept { return participants_.size(); }

 private:
  struct Pending {
    std::uint32_t writer = 0;
    std::int64_t sequence_number = 0;
    std::uint32_t sample_bytes = 0;
    std::uint32_t missing = 0;  // fragments
    Clock::time_point since;
  };
  struct Participant {
    std::uint32_t address = 0;  // of the first announcement
    Clock::duration lease{};
    Clock::time_point heard;
    std::vector<Pending> pending;
    std::int64_t gaps = 0;  // samples declared missing since gaps_since
    Clock::time_point gaps_since;
  };
  struct Allowance {
    double left = unannounced_at_once;
    Clock::time_point at;
  };
  struct Hash {
    std::size_t operator()(const Prefix& prefix) const noexcept;
  };

  [[nodiscard]] Refusal announce(std::uint32_t address, const Claims::Announcement& announcement,
                                 Clock::time_point now);
  void forget_silent(Clock::time_point now);
  [[nodiscard]] bool spend(std::uint32_t address, Clock::time_point now);
  [[nodiscard]] static Refusal claim(Participant& sender, const Claims& claims, Clock::time_point now);

  bool relayed_;
  Clock::time_point swept_;
  std::unordered_map<Prefix, Participant, Hash> participants_;
  std::unordered_map<std::uint32_t, std::size_t> announced_;  // participants by address
  std::unordered_map<std::uint32_t, Allowance> allowances_;   // of addresses
};

}  // namespace aloft::bus::guard
