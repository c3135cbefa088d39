#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "common/base/process_name.hpp"
#include "common/experiment/experiment.hpp"
#include "common/experiment/summary.hpp"
#include "common/flight/flight.hpp"
#include "common/store/result_folder.hpp"

namespace aloft::store {

using experiment::FlightSummary;

/// No room left on the disk. Nothing of the batch was stored, nothing stored before is lost: try again later.
class StoreFull : public FormattedError {
  using FormattedError::FormattedError;
};

/// The trace as Protobuf (idl/trace.proto), the same bytes for the same record. These bytes are stored, hashed and
/// sent.
[[nodiscard]] std::string encode_trace(const flight::FlightRecord& record);
/// Throws IntegrityError.
[[nodiscard]] flight::FlightRecord decode_trace(std::string_view bytes);

/// The coordinator of a run locks this file in the result folder.
inline constexpr std::string_view coordinator_lock_name = "coordinator.lock";

enum class Stored : std::uint8_t { added, already_there };

/// results.sqlite: every finished flight under (condition, trial, agent). One writer, any number of readers.
class ResultStore {
 public:
  /// Creates or opens DIR/results.sqlite for this experiment, and writes DIR/experiment.json (the resolved experiment
  /// and the build). InputError if DIR holds another experiment's results (the message names the first difference) or
  /// other files, cannot be written, or another process is writing into it; IntegrityError with a hint if the database
  /// is corrupt, or rows were removed from it. Leaves nothing behind if it throws.
  static ResultStore open_for_writing(const std::filesystem::path& dir, const experiment::Experiment& experiment);
  /// Opens an existing result folder, read only; another process may be writing into it. InputError if there is none,
  /// IntegrityError as above.
  static ResultStore open_for_reading(const std::filesystem::path& dir);
  /// Whether there is a database in this folder, damaged or not.
  [[nodiscard]] static bool exists(const std::filesystem::path& dir);

  ResultStore(ResultStore&&) noexcept;
  ~ResultStore();

  /// The experiment whose results these are.
  [[nodiscard]] const experiment::Experiment& experiment() const noexcept;
  /// What open_for_writing created.
  [[nodiscard]] const MadeResults& made() const noexcept;
  /// Throws ResultsGone if the folder is no longer where it was when it was opened for writing. From any thread.
  void check_in_place() const;

  /// Storing is idempotent; a second record of the same flight with another digest throws IntegrityError (except of a
  /// relay with failover, whose first record counts), as does a trace that cannot be decoded or has no steps. `memory`
  /// (Agent::save_state after the flight) must be given for agents that remember earlier flights and for no others
  /// (IntegrityError); it is stored together with the flight. Durable (kill -9, power loss) once it returns, unless a
  /// batch is open. Throws StoreFull if the disk is full. One thread at a time.
  Stored add(const experiment::FlightKey& key, std::string_view encoded_trace, std::string_view memory = {});
  /// Everything added inside `work` becomes durable together, or nothing if it throws. Not nested. Throws ResultsGone
  /// if the folder was moved or replaced meanwhile.
  void batch(const std::function<void()>& work);

  /// Notes in the database which process writes into it now; so a copy of the folder names another process as soon as
  /// that one writes into it. Throws StoreFull as add() does.
  void sign(const ProcessName& writer);
  /// The process that signed last; nullopt if none did.
  [[nodiscard]] std::optional<ProcessName> writer() const;

  /// Whether this flight is stored. std::logic_error if the experiment has no such flight.
  [[nodiscard]] bool holds(const experiment::FlightKey& key) const;
  /// False if the file is no longer where it was opened: what is written is lost.
  [[nodiscard]] bool in_place() const;
  /// How many flights are stored.
  [[nodiscard]] std::uint64_t count() const;
  [[nodiscard]] std::set<experiment::FlightKey> keys() const;
  /// Visits all flights in canonical order, without holding all of them in memory. Throws as flights().
  void for_each_flight(const std::function<void(const FlightSummary&)>& visit) const;
  /// The same in parts, for readers that have other things to do in between: at most `limit` flights from `from` on (0:
  /// the first). Returns where the next part begins; nullopt if there are no more flights.
  std::optional<std::int64_t> visit_part(std::int64_t from, std::uint32_t limit,
                                         const std::function<void(const FlightSummary&)>& visit) const;
  /// Canonical order: condition, trial, then the experiment's order of agents. Throws IntegrityError if a row was
  /// altered.
  [[nodiscard]] std::vector<FlightSummary> flights() const;
  /// The encoded trace; throws IntegrityError if its digest does not match, InputError if this flight is not stored.
  [[nodiscard]] std::string trace(const experiment::FlightKey& key) const;

  /// What the agent remembered after this flight; nullopt if it is not the latest stored flight of its lineage. Throws
  /// IntegrityError if the digest does not match.
  [[nodiscard]] std::optional<std::string> memory(const experiment::FlightKey& key) const;

  /// One SHA-256 over all flights in canonical order.
  [[nodiscard]] std::string digest() const;

 private:
  struct State;
  explicit ResultStore(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

/// The flights of an experiment that are missing among its results.
struct Shortfall {
  std::uint64_t flights = 0;
  std::vector<experiment::FlightKey> first;  ///< in canonical order, at most as many as were asked for

  /// "3 of 72 flights are missing: agent dqn in trial 4 of condition 1 (density=5), ... and 2 more"
  [[nodiscard]] std::string text(const experiment::Experiment& experiment) const;
};
[[nodiscard]] Shortfall shortfall(const ResultStore& results, std::size_t named = 10);

/// The summary (experiment/summary.hpp) of all stored flights.
[[nodiscard]] nlohmann::ordered_json summarise(const ResultStore& results);
/// Writes the summary as DIR/summary.json and DIR/summary.csv, for the results in DIR. Throws like open_for_reading.
void write_summary(const std::filesystem::path& dir);

}  // namespace aloft::store
