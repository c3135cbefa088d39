#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "common/experiment/experiment.hpp"
#include "common/store/result_store.hpp"
#include "services/metrics/instruments.hpp"

namespace aloft::metrics {

using Clock = std::chrono::steady_clock;

/// A finished flight as it comes from a channel.
struct Record {
  std::string experiment_id;
  std::uint64_t episode_id = 0;
  experiment::FlightKey key;
  std::string worker;
  std::string trace;   ///< store::encode_trace
  std::string memory;  ///< of agents that remember earlier flights, else empty
};

/// A flight that is in the database for good.
struct Acknowledgement {
  std::uint64_t episode_id = 0;
  experiment::FlightKey key;
  std::string digest;
  bool is_new = false;  ///< it was not there before
};

struct CollectorOptions {
  std::chrono::milliseconds batch_time{50};
  std::size_t batch_records = 64;
  std::chrono::milliseconds retry_time{1000};  ///< after a commit that failed
  std::size_t queue_bytes = 64U << 20U;        ///< beyond this, records are left to be sent again
};

/// Checks records, stores them in batches and returns what can be acknowledged. No bus: the caller brings records and
/// the time. Nothing is acknowledged before it is durable; what is not acknowledged will be sent again.
class Collector {
 public:
  /// Adds these flights durably, all or none; returns for each whether it was new. Throws what ResultStore throws.
  using Commit = std::function<std::vector<store::Stored>(const std::vector<Record>&)>;

  Collector(const experiment::Experiment& experiment, Commit commit, Instruments& instruments,
            CollectorOptions options = {});

  /// Checks and queues one record. Returns why it was refused, or nothing.
  std::optional<std::string> offer(Record record, Clock::time_point now);

  /// Commits if a batch is due (or `flush`). A full disk or a locked database pauses the collector and keeps the
  /// batch. Throws IntegrityError if a flight was stored before with another digest, or the database is broken;
  /// store::ResultsGone if it is no longer where it was.
  std::vector<Acknowledgement> commit_due(Clock::time_point now, bool flush = false);

  /// When commit_due() will have something to do; none while the queue is empty.
  [[nodiscard]] std::optional<Clock::time_point> next_due() const;

  /// Why nothing can be stored at the moment; empty if all is well.
  [[nodiscard]] const std::string& paused_because() const noexcept { return paused_because_; }
  [[nodiscard]] std::size_t queued() const noexcept { return queue_.size(); }

 private:
  [[nodiscard]] std::optional<std::string> check(const Record& record, std::size_t& steps);
  std::string refuse(Rejection reason, const Record& record, std::string_view why);

  const experiment::Experiment& experiment_;
  Commit commit_;
  Instruments& instruments_;
  CollectorOptions options_;
  std::vector<Record> queue_;
  std::vector<std::size_t> queue_steps_;
  std::size_t queue_bytes_ = 0;
  Clock::time_point oldest_;
  Clock::time_point retry_at_;
  std::string paused_because_;
};

/// The commit of a real store.
[[nodiscard]] Collector::Commit commit_to(store::ResultStore& store);

}  // namespace aloft::metrics
