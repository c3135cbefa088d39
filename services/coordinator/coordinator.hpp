#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "common/experiment/experiment.hpp"
#include "services/coordinator/lease_ledger.hpp"
#include "services/coordinator/namesakes.hpp"

namespace aloft::coordinator {

struct CoordinatorOptions {
  TrialOrder order = TrialOrder::canonical;
  std::uint32_t fail_fast = 0;  ///< stop after so many trials failed for good; 0: never
  Clock::duration heartbeat_timeout = std::chrono::seconds(3);
  Clock::duration unclaimed_timeout = std::chrono::seconds(5);
  /// A resumed run first listens this long for leases that are still being flown.
  Clock::duration adoption_time = std::chrono::seconds(1);
  /// Silence after which the status names what the run waits for.
  Clock::duration patience = std::chrono::seconds(4);
};

/// A worker's status, independent of the wire types.
struct WorkerNews {
  WorkerReport report;
  std::string host;
  std::uint32_t pid = 0;
  std::uint64_t steps_done = 0;                                      ///< since the worker started
  std::uint32_t records_unconfirmed = 0;                             ///< finished flights, not known to be stored
  std::vector<std::string> flies_only;                               ///< agents; empty: all
  std::string_view waits_for;                                        ///< missing peers, as the worker names them
  std::vector<std::pair<std::uint64_t, std::string>> failed_leases;  ///< with the reason; every status repeats them
};

/// To be sent to a worker: fly this trial, or (cancelled) forget it.
struct Order {
  std::string worker;
  std::uint64_t lease = 0;
  std::uint32_t condition = 0;
  std::uint32_t trial = 0;
  std::uint32_t attempt = 0;
  std::vector<std::string> agents;
  bool cancelled = false;
};

struct Progress {
  std::uint64_t flights_total = 0;
  std::uint64_t flights_stored = 0;
  std::uint64_t trials_pending = 0;  ///< lost ones included
  std::uint64_t trials_leased = 0;
  std::uint64_t trials_done = 0;
  std::uint64_t trials_failed = 0;
  std::uint32_t workers_alive = 0;
  double flights_per_s = 0.0;  ///< means of the last seconds
  double steps_per_s = 0.0;
  std::string message;  ///< what the run waits for, or the last trouble; empty if all is well
};

/// Runs one experiment on the workers that report: adds names and messages for people to the ledger. No bus; the clock
/// is passed in.
class Coordinator {
 public:
  Coordinator(const experiment::Experiment& experiment, const CoordinatorOptions& options, std::uint32_t first_grant,
              Clock::time_point now);

  /// A flight was stored before this process started. False if the experiment has no such flight.
  bool resume(const experiment::FlightKey& flight);

  /// Whether the experiment has this flight.
  [[nodiscard]] bool knows(const experiment::FlightKey& flight) const;

  void on_worker(const WorkerNews& news, Clock::time_point now);
  /// False if the experiment has no such flight.
  bool on_flight_stored(const experiment::FlightKey& flight, Clock::time_point now);

  /// Why the collector cannot store at the moment, to be repeated as long as it cannot; empty if it can.
  void on_collector_paused(std::string why, Clock::time_point now);
  /// Reports a problem to people, in the log and in the status.
  void trouble(std::string what, Clock::time_point now);

  /// Notices silent workers and grants leases; returns what has to be sent.
  [[nodiscard]] std::vector<Order> tick(Clock::time_point now);

  [[nodiscard]] Progress progress(Clock::time_point now) const;
  /// Every trial is done or failed, or too many failed (fail_fast).
  [[nodiscard]] bool over() const;
  [[nodiscard]] bool succeeded() const { return ledger_.finished() && ledger_.count(TrialState::failed) == 0; }
  /// Flights that count as stored but are not among the results: `is_there` has an entry per flight (number_of).
  [[nodiscard]] std::vector<experiment::FlightKey> lost_flights(const std::vector<bool>& is_there) const;
  /// The flight's place in canonical order. The experiment must have it.
  [[nodiscard]] std::size_t number_of(const experiment::FlightKey& flight) const;
  /// One line per trial that failed for good, at most LeaseLedger::reasons_kept.
  [[nodiscard]] std::vector<std::string> failure_report() const;

 private:
  struct WorkerProgress {
    std::uint64_t incarnation = 0;
    std::uint64_t steps_done = 0;
    std::uint32_t records_unconfirmed = 0;
    std::string waits_for;
    std::vector<bool> flies;  // by agent; empty: all
  };
  struct Rate {
    double per_s = 0.0;
    std::uint64_t count = 0;
    std::uint64_t counted = 0;
    void update(double elapsed_s);
  };

  bool store(const experiment::FlightKey& flight);
  [[nodiscard]] std::string trial_name(std::uint32_t condition, std::uint32_t trial) const;
  [[nodiscard]] std::string trial_names(const std::vector<std::uint64_t>& leases) const;
  [[nodiscard]] std::string missing_agents(std::uint32_t condition, std::uint32_t trial) const;
  [[nodiscard]] std::string waiting_for(Clock::time_point now) const;
  void forget(std::string_view worker);
  [[nodiscard]] std::vector<bool> flies(const WorkerNews& news) const;
  void find_unserved(Clock::time_point now);
  void count_steps(const WorkerNews& news);
  void take_failures(const WorkerNews& news, Clock::time_point now);
  void hold_back(const WorkerNews& news);
  void cancel(std::string_view worker, std::uint64_t lease);
  void tell_lost(const std::vector<LostWorker>& lost, Clock::time_point now);

  const experiment::Experiment& experiment_;
  CoordinatorOptions options_;
  LeaseLedger ledger_;
  std::map<std::string, std::uint32_t, std::less<>> agent_index_;
  std::map<std::string, WorkerProgress, std::less<>> workers_;
  Namesakes namesakes_;
  std::uint64_t records_unconfirmed_ = 0;  // of all workers
  std::vector<Order> cancellations_;
  Clock::time_point grant_from_;
  Clock::time_point worker_seen_;  // when a worker last reported
  Clock::time_point stored_at_;    // when a flight was last stored, or none waited to be stored
  std::string trouble_;
  Clock::time_point trouble_at_;
  std::vector<std::uint64_t> flights_missing_;  // by agent
  std::string unserved_;                        // agents whose flights are missing, and that no worker flies
  Clock::time_point unserved_since_;
  std::string collector_paused_;
  Clock::time_point collector_paused_at_;
  Rate flights_;
  Rate steps_;
  Clock::time_point rates_at_;
};

}  // namespace aloft::coordinator
