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

/// Finished flights, kept until the collector says that they are stored, or never will be. No bus: the caller sends.
class Outbox {
 public:
  using Send = std::function<void(wire::EpisodeRecord&)>;

  void add(wire::EpisodeRecord record, Clock::time_point now);
  /// Forgets a record; returns the lease it was flown under, or nothing if no record with this trace is here: what is
  /// said about another trace says nothing about ours.
  std::optional<std::uint64_t> settle(std::uint64_t episode_id, std::string_view trace_sha256, Clock::time_point now);
  /// Sends what was never sent, and again what has not been confirmed for 2 s.
  void send_due(Clock::time_point now, const Send& send);
  /// There is somebody who may not have heard any of it: all of it is due.
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
