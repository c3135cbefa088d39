#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <string_view>

#include "common/bus/wire.hpp"

namespace aloft::channel {

using Clock = std::chrono::steady_clock;

/// Finished flights, kept until the collector confirms or refuses them. No bus: the caller sends.
class Outbox {
 public:
  using Send = std::function<void(wire::EpisodeRecord&)>;

  void add(wire::EpisodeRecord record, Clock::time_point now);
  /// Forgets a record that was confirmed or refused; returns the lease it was flown under, or nothing if no record with
  /// this trace is here: the message is about another trace.
  std::optional<std::uint64_t> settle(std::uint64_t episode_id, std::string_view trace_sha256, Clock::time_point now);
  /// Sends new records, and those again that have been unconfirmed for 2 s.
  void send_due(Clock::time_point now, const Send& send);
  /// Makes all records due, for a new collector that may have received none of them.
  void start_over() noexcept;

  [[nodiscard]] std::size_t size() const noexcept { return entries_.size(); }
  /// How long the collector has confirmed nothing although records wait; zero if none waits.
  [[nodiscard]] Clock::duration silence(Clock::time_point now) const noexcept;

 private:
  struct Entry {
    wire::EpisodeRecord record;
    std::string trace_sha256;
    Clock::time_point due;
  };
  std::map<std::uint64_t, Entry> entries_;  // by episode
  Clock::time_point progress_;              // last confirmation, or when the first record came
};

}  // namespace aloft::channel
