#pragma once

#include <chrono>
#include <cstdint>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "common/bus/endpoint.hpp"
#include "common/experiment/experiment.hpp"
#include "common/store/result_store.hpp"

namespace aloft::test {

/// A made-up flight, a pure function of the experiment's seed and the key.
[[nodiscard]] std::string synthetic_trace(const experiment::Experiment& experiment, const experiment::FlightKey& key);

/// Every flight of an experiment in canonical order.
[[nodiscard]] std::vector<experiment::FlightKey> all_flights(const experiment::Experiment& experiment);

/// Simulates a whole worker for coordinator and collector: takes assignments, "flies" synthetic flights, keeps
/// its records until they are confirmed. Does all of it inside pump(), in the test's thread.
class FakeWorker {
 public:
  using Clock = std::chrono::steady_clock;

  FakeWorker(const experiment::Experiment& experiment, const std::string& run, int domain, const std::string& name);

  struct Behaviour {
    std::uint32_t capacity = 2;
    bool silent = false;      ///< as if stopped: nothing is sent or flown
    bool duplicates = false;  ///< every record is sent twice
    int flights_per_pump = 1;
    std::set<std::pair<std::uint32_t, std::uint32_t>> failing;  ///< (condition, trial) that it reports as failed
    std::uint64_t incarnation = 1;
  } behaviour;

  void pump();
  void send(const experiment::FlightKey& key, const std::string& trace, const std::string& experiment_id);

  [[nodiscard]] const std::map<experiment::FlightKey, int>& flown() const { return flown_; }
  [[nodiscard]] std::size_t leases() const { return leases_.size(); }
  [[nodiscard]] std::size_t confirmations() const { return confirmations_; }
  /// Why the collector refused records of this experiment.
  [[nodiscard]] const std::vector<std::string>& refusals() const { return refusals_; }
  [[nodiscard]] bool records_matched() const { return records_.matched() > 0; }
  /// The run's own collector, as the coordinator announces it.
  [[nodiscard]] std::uint64_t collector() const { return collector_; }
  [[nodiscard]] wire::RunState run_state() const { return run_state_; }
  [[nodiscard]] const std::string& run_message() const { return run_message_; }

 private:
  struct Lease {
    std::vector<experiment::FlightKey> to_fly;
    std::set<experiment::FlightKey> unconfirmed;
  };

  void listen();
  void take(const wire::TrialAssignment& assignment);
  void fly();
  void send_again();
  void report();

  const experiment::Experiment& experiment_;
  std::string name_;
  bus::Participant participant_;
  bus::Writer<wire::WorkerStatus> status_{participant_};
  bus::Writer<wire::EpisodeRecord> records_{participant_};
  bus::Reader<wire::TrialAssignment> assignments_{participant_};
  bus::Reader<wire::EpisodeStored> stored_{participant_};
  bus::Reader<wire::RecordRefused> refused_{participant_};
  bus::Reader<wire::RunControl> controls_{participant_};
  bus::Reader<wire::RunStatus> runs_{participant_};
  std::map<std::uint64_t, Lease> leases_;
  std::set<std::uint64_t> seen_;
  std::map<experiment::FlightKey, Clock::time_point> outbox_;
  std::vector<wire::LeaseFailure> failures_;
  std::map<experiment::FlightKey, int> flown_;
  std::vector<std::string> refusals_;
  std::size_t confirmations_ = 0;
  std::uint64_t collector_ = 0;
  std::uint64_t heartbeat_ = 0;
  std::uint64_t steps_ = 0;
  Clock::time_point reported_at_;
  wire::RunState run_state_ = wire::RUN_RUNNING;
  std::string run_message_;
};

}  // namespace aloft::test
