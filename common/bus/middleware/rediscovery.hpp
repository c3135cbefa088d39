#pragma once

// Fault of Fast DDS: two processes that lost each other for a while may not get each other's endpoints again. It
// forgets a process that is silent for longer than its lease, with its writers and readers; when the process is back,
// the list of its endpoints has to come again. If only one of the two had forgotten the other, the list may never come:
// it was received once, so the other side does not send it again. (A heartbeat that arrives before the first request
// for the list makes the middleware go wrong.) Upstream: issue 6401; 2.9.1, 3.1.2 and 3.3.0 have it. Can go when
// tests/faults/standstill_test.cpp passes with an empty Participant::State::ask.
//
// Inside common/bus only.

#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <functional>
#include <map>
#include <mutex>
#include <optional>
#include <set>
#include <string>
#include <thread>
#include <vector>

#include "common/bus/middleware/generation.hpp"

namespace aloft::bus {

/// Decides which peers are to be asked for their endpoints.
///
/// A process that misses the list of a peer asks it, and the peer announces all its endpoints again. The question
/// travels as user data of one of the asker's readers. The peer receives it: of two processes only the one that was the
/// last to forget the other can miss anything.
///
/// Can be used from any thread. No bus; the clock is passed in.
class Rediscovery {
 public:
  using Clock = std::chrono::steady_clock;
  using Process = rtps::GuidPrefix_t;
  using Endpoint = rtps::GUID_t;
  using Question = std::vector<std::uint8_t>;
  enum class Kind : std::uint8_t { writer, reader };

  // --- what the middleware reports about peers ---

  void heard(const Process& process, const std::string& name, Clock::time_point now);
  /// The process itself or the discovery server announced it.
  void left(const Process& process);
  /// Its lease has expired; later than it left, if it has.
  void fell_silent(const Process& process, Clock::time_point now);
  void found(const Endpoint& endpoint, Kind kind);
  void removed(const Endpoint& endpoint, Kind kind);

  // --- asking ---

  /// True as long as a peer is back and its list is missing.
  [[nodiscard]] bool waits() const;
  /// A new question to all peers whose list is due; nullopt if none is. Logs the peers that it asks.
  [[nodiscard]] std::optional<Question> question(Clock::time_point now);
  /// Handles the question of a peer. True if it is new and asks this process.
  bool asks(const Process& asker, const Question& question, const Process& self);

  /// Names of peers that may be back soon: silent for less than `patience` with no other process of the same name in
  /// their place, or back a moment ago.
  [[nodiscard]] std::vector<std::string> absent(Clock::duration patience, Clock::time_point now) const;

 private:
  struct Peer {
    std::string name;
    std::set<Endpoint> writers;
    std::set<Endpoint> readers;
    bool had_writers = false;
    bool had_readers = false;
    bool gone = false;
    std::optional<Clock::time_point> silent_since;  // none: here, or it has left
    unsigned times_asked = 0;
    std::uint32_t number = 0;              // of the latest question
    std::optional<Clock::time_point> due;  // of the next question; none: nothing is missing

    [[nodiscard]] bool complete() const noexcept {
      return (!had_writers || !writers.empty()) && (!had_readers || !readers.empty());
    }
  };
  Peer& peer_of(const Process& process);
  static void forget(Peer& peer);

  mutable std::mutex mutex_;
  std::map<Process, Peer> peers_;
  std::map<Process, std::uint32_t> answered_;  // the latest question of each
  std::uint32_t last_number_ = 0;
};

/// Asks and answers in a thread of its own: the middleware's threads, which report peers, must not call the middleware.
class RediscoveryThread {
 public:
  using Ask = std::function<void(const Rediscovery::Question&)>;

  /// `ask` makes a question known to all, `announce` all our endpoints.
  RediscoveryThread(Rediscovery& rediscovery, Ask ask, std::function<void()> announce);

  /// A peer is back, and its endpoints may be missing.
  void peer_is_back();
  /// A peer asks for our endpoints.
  void peer_asks();
  /// From now on nothing is asked or announced.
  void end();

 private:
  void work(const std::stop_token& stop);

  Rediscovery& rediscovery_;
  Ask ask_;
  std::function<void()> announce_;
  std::mutex mutex_;
  std::condition_variable_any changed_;
  bool peer_is_back_ = false;
  bool peer_asks_ = false;
  std::jthread thread_;
};

}  // namespace aloft::bus
