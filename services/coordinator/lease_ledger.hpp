#pragma once

#include <array>
#include <chrono>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

#include "services/coordinator/index_list.hpp"

namespace aloft::coordinator {

using Clock = std::chrono::steady_clock;

/// Without trouble, pending -> leased -> done. A lease whose worker went silent makes the trial lost until it is leased
/// again; a lease that failed makes it pending again, or failed after the last attempt.
enum class TrialState : std::uint8_t { pending, leased, done, failed, lost };
inline constexpr std::size_t trial_states = 5;

/// In which order trials are leased. Results must not depend on it.
enum class TrialOrder : std::uint8_t { canonical, shuffled };

struct LedgerOptions {
  std::uint32_t conditions = 1;
  std::uint32_t trials = 1;        ///< per condition
  std::uint32_t agents = 1;        ///< flights per trial, 1..4096
  std::uint32_t max_attempts = 3;  ///< a trial fails for good at its max_attempts-th failed lease; 1..255
  /// A trial fails for good when this many workers were lost while they flew it: it probably kills them. 1..255
  std::uint32_t max_losses = 25;
  Clock::duration heartbeat_timeout = std::chrono::seconds(3);
  /// A lease that its worker does not list in its heartbeats for this long is lost: the assignment never arrived, or
  /// the process that held it died while the rest of the worker lives.
  Clock::duration unclaimed_timeout = std::chrono::seconds(5);
  /// 0: trials are independent. k: trial t of a condition waits until its trial t - k is done, so that k chains of
  /// trials run in order (agents that carry their memory from one trial to the next).
  std::uint32_t lineages = 0;
  TrialOrder order = TrialOrder::canonical;
  std::uint64_t order_seed = 1;
  /// Number of the first lease. Take a random one in every process, so that its leases are not mistaken for those of
  /// the process before it.
  std::uint32_t first_grant = 0;
};

/// What a worker reports about itself.
struct WorkerReport {
  std::string_view name;
  std::uint64_t incarnation = 0;  ///< changes when the worker restarts (its process id)
  std::uint32_t capacity = 0;     ///< trials it wants at a time, at most max_capacity are given; 0: it leaves for good
  std::span<const std::uint64_t> leases;  ///< held by the worker
  std::vector<bool> flies{};              ///< by agent; empty: all
};

/// One trial for one worker.
struct Lease {
  std::uint64_t id = 0;
  std::string worker;
  std::uint32_t condition = 0;
  std::uint32_t trial = 0;
  std::uint32_t attempt = 1;          ///< 1 + failures + losses so far
  std::vector<std::uint32_t> agents;  ///< only those whose flights are missing
};

/// What a heartbeat changed.
struct HeartbeatResult {
  bool joined = false;                 ///< not known before, or restarted
  bool left = false;                   ///< known before, and has just left in good order
  std::vector<std::uint64_t> adopted;  ///< leases of an earlier coordinator, or of a worker that was thought lost
  std::vector<std::uint64_t> cancel;   ///< leases that the worker holds without right: done, or leased to another
  std::vector<std::uint64_t> lost;     ///< leases taken back from this worker
};

struct LostWorker {
  std::string name;
  Clock::duration silent_for{};
  std::vector<std::uint64_t> leases;
};

struct Failure {
  std::uint32_t condition = 0;
  std::uint32_t trial = 0;
  std::string reason;
};

/// Which worker flies which trial, without clock, files or bus. Every event costs O(1) (a heartbeat: O(leases of that
/// worker)), a trial 20 bytes plus one bit per flight. Every event can arrive twice, late or for a worker that is gone.
class LeaseLedger {
 public:
  static constexpr std::uint32_t max_capacity = 64;
  static constexpr std::size_t reasons_kept = 1000;

  /// std::invalid_argument if an option is out of range.
  explicit LeaseLedger(const LedgerOptions& options);

  /// Notes that a flight is in the database, now or since an earlier run. False if that was known.
  bool flight_stored(std::uint32_t condition, std::uint32_t trial, std::uint32_t agent);

  /// std::invalid_argument if `flies` is neither empty nor one entry per agent.
  HeartbeatResult heartbeat(const WorkerReport& report, Clock::time_point now);

  /// Notes that the worker gave the trial up. Ignored unless the lease is live.
  void lease_failed(std::uint64_t lease, std::string_view reason);

  /// Removes workers that have been silent for too long; returns them with the leases that return to the queue.
  std::vector<LostWorker> expire(Clock::time_point now);

  /// The next lease for some worker with free capacity, in turn; false if there is no such worker or no such trial.
  /// A lost or failed trial goes to another worker than before if that needs no waiting. A worker that flies only some
  /// agents gets these flights of a trial; the others wait for a worker that flies them.
  bool grant(Clock::time_point now, Lease& lease);

  [[nodiscard]] bool finished() const noexcept;  ///< every trial is done or failed
  [[nodiscard]] std::uint64_t count(TrialState state) const noexcept {
    return counts_[static_cast<std::size_t>(state)];
  }
  [[nodiscard]] std::uint64_t flights_total() const noexcept { return slots_.size() * options_.agents; }
  [[nodiscard]] std::uint64_t flights_stored() const noexcept { return flights_stored_; }
  [[nodiscard]] std::size_t workers_alive() const noexcept { return names_.size(); }

  [[nodiscard]] TrialState state(std::uint32_t condition, std::uint32_t trial) const;
  [[nodiscard]] bool is_stored(std::uint32_t condition, std::uint32_t trial, std::uint32_t agent) const;
  /// The trial that a lease id names, whether the lease is live or not; none if no trial has it.
  [[nodiscard]] std::optional<std::pair<std::uint32_t, std::uint32_t>> trial_of(std::uint64_t lease) const noexcept;
  /// Trials that failed for good, oldest first; at most reasons_kept of them.
  [[nodiscard]] std::vector<Failure> failures() const;
  /// Bytes held, for benchmarks.
  [[nodiscard]] std::size_t memory_bytes() const noexcept;

 private:
  static constexpr std::uint32_t none = IndexList::none;
  enum class Queue : std::uint8_t { nowhere, fresh, retry };

  struct Slot {
    std::uint32_t worker = none;  // that holds it or held it last; then other workers are preferred
    std::uint16_t missing = 0;    // flights
    TrialState state = TrialState::pending;
    Queue queue = Queue::nowhere;
    std::uint8_t failures = 0;
    std::uint8_t losses = 0;
  };
  struct LiveLease {
    std::uint64_t id = 0;
    Clock::time_point listed;  // when the worker last showed that it has it, or when it was granted
  };
  struct Worker {
    std::string name;
    std::uint64_t incarnation = 0;
    std::uint32_t capacity = 0;
    bool hungry = false;  // is in hungry_
    Clock::time_point seen;
    std::vector<LiveLease> leases;
    std::vector<bool> flies;  // by agent; empty: all
  };
  struct NameHash : std::hash<std::string_view> {
    using is_transparent = void;
  };

  [[nodiscard]] std::uint32_t index(std::uint32_t condition, std::uint32_t trial) const;
  [[nodiscard]] static std::uint32_t trial_index(std::uint64_t lease) noexcept {
    return static_cast<std::uint32_t>(lease >> 32U);
  }
  /// The trial before or after in the same lineage; none at its ends.
  [[nodiscard]] std::uint32_t predecessor(std::uint32_t trial_index) const noexcept;
  [[nodiscard]] std::uint32_t successor(std::uint32_t trial_index) const noexcept;

  void set_state(std::uint32_t trial_index, TrialState state) noexcept;
  void enqueue(std::uint32_t trial_index, Queue queue) noexcept;
  void dequeue(std::uint32_t trial_index) noexcept;
  [[nodiscard]] bool has_work_for(std::uint32_t worker, std::uint32_t trial_index) const noexcept;
  [[nodiscard]] std::uint32_t rotate_to_first_for(std::uint32_t worker, IndexList& queue) noexcept;
  [[nodiscard]] std::uint32_t seek_trial_for(std::uint32_t worker) noexcept;
  [[nodiscard]] std::vector<std::uint32_t> missing_agents(std::uint32_t worker, std::uint32_t trial_index) const;

  std::uint32_t add_worker(const WorkerReport& report);
  void remove_worker(std::uint32_t worker);
  void leave(std::uint32_t worker, HeartbeatResult& result);
  void update_hungry(std::uint32_t worker);
  bool claim(std::uint32_t worker, std::uint64_t lease, Clock::time_point now, HeartbeatResult& result);
  [[nodiscard]] bool holds(std::uint32_t worker, std::uint64_t lease) const noexcept;
  void erase_lease(std::uint32_t trial_index) noexcept;
  void lose(std::uint32_t trial_index);
  void fail_for_good(std::uint32_t trial_index, std::string reason);

  LedgerOptions options_;
  std::vector<Slot> slots_;
  std::vector<IndexList::Links> links_;  // of fresh_ and retry_
  std::vector<bool> stored_;             // [trial * agents + agent]
  IndexList fresh_;
  IndexList retry_;
  std::array<std::uint64_t, trial_states> counts_{};
  std::uint64_t flights_stored_ = 0;
  std::uint32_t grants_ = 0;

  std::unordered_map<std::string, std::uint32_t, NameHash, std::equal_to<>> names_;
  std::vector<Worker> workers_;
  std::vector<std::uint32_t> free_workers_;
  std::vector<IndexList::Links> seen_links_;
  std::vector<IndexList::Links> hungry_links_;
  IndexList seen_;    // by last heartbeat, oldest first
  IndexList hungry_;  // with free capacity, in turn

  std::vector<std::pair<std::uint32_t, std::string>> reasons_;
};

}  // namespace aloft::coordinator
