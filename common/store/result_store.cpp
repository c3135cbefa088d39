#include "common/store/result_store.hpp"

#include <SQLiteCpp/VariadicBind.h>
#include <fmt/format.h>

#include <bit>
#include <limits>
#include <stdexcept>

#include "common/base/build_info.hpp"
#include "common/base/digest.hpp"
#include "common/base/error.hpp"
#include "common/base/json_text.hpp"
#include "common/base/write_file.hpp"
#include "common/experiment/identity.hpp"
#include "common/store/database.hpp"
#include "common/store/flight_table.hpp"

namespace aloft::store {
namespace {

using experiment::Experiment;
using experiment::FlightKey;

/// Covers the memory and its flight, so that it cannot pass for the memory of another flight.
std::string memory_digest(const FlightKey& key, std::string_view memory) {
  Digest digest;
  digest.add(fmt::format("{} {} {}\n", key.condition, key.trial, key.agent));
  digest.add(memory);
  return digest.hex();
}

std::string resolved_file(const Experiment& experiment) {
  nlohmann::json resolved = experiment.canonical;
  resolved["build"] = std::string(build_id());
  return resolved.dump(2) + "\n";
}

}  // namespace

struct ResultStore::State {
  State(const std::filesystem::path& dir, Access access)
      : file(dir / database_name),
        lock(access == Access::write ? lock_for_writing(dir) : Descriptor()),
        is_new(access == Access::write && !std::filesystem::exists(file)),
        database(open_database(file, access)),
        flights(*database, file, experiment) {}

  std::filesystem::path file;
  Descriptor lock;
  bool is_new;
  std::unique_ptr<SQLite::Database> database;
  Experiment experiment;
  FlightTable flights;
  MadeResults made;
  std::optional<FolderWatch> watch;  // only when opened for writing
  bool batch_open = false;

  /// The canonical experiment in the database; empty if there is none yet.
  [[nodiscard]] std::string stored_canonical() const {
    SQLite::Statement query(*database, "SELECT canonical, canonical_sha256 FROM experiment");
    if (!query.executeStep()) return {};
    std::string canonical = query.getColumn(0).getString();
    if (sha256_hex(canonical) != query.getColumn(1).getString()) refuse_damaged(file, "the experiment was altered");
    return canonical;
  }

  /// Refuses the results of another experiment before anything is written.
  void begin_writing() {
    const std::string stored = stored_canonical();
    if (!stored.empty()) {
      if (const nlohmann::json there = parse_json(stored, file.string()); experiment::id_of(there) != experiment.id)
        throw InputError(
            "'{}' holds the results of another experiment: {}. Name another folder with --out, or move this "
            "one away",
            file.parent_path().string(), experiment::describe_differences(there, experiment.canonical));
    }
    SQLite::Transaction transaction(*database, SQLite::TransactionBehavior::IMMEDIATE);
    update_format(*database);
    flights.add_missing_columns();
    if (stored.empty()) store_experiment();
    transaction.commit();
    check_memories();
  }

  /// A lineage cannot go on without the memory of its latest flight.
  void check_memories() const {
    for (const agents::AgentSpec& agent : experiment.agents) {
      if (agent.lineages() == 0) continue;
      SQLite::Statement lost(
          *database,
          "SELECT condition, last FROM (SELECT condition, trial % ?1 AS lineage, max(trial) AS last FROM flight "
          "WHERE agent = ?2 GROUP BY condition, lineage) AS latest WHERE NOT EXISTS (SELECT 1 FROM memory WHERE "
          "memory.condition = latest.condition AND memory.agent = ?2 AND memory.lineage = latest.lineage AND "
          "memory.trial = last) LIMIT 1");
      SQLite::bind(lost, agent.lineages(), agent.name);
      if (lost.executeStep())
        refuse_damaged(file, fmt::format("the memory of agent '{}' after condition {}, trial {} was removed",
                                         agent.name, lost.getColumn(0).getInt64(), lost.getColumn(1).getInt64()));
    }
  }

  /// SQLite's log and its index exist as long as the database is open. SQLite itself reports whether the folder was
  /// replaced while the database was being opened.
  void begin_watch() {
    const std::string name = database_name;
    watch.emplace(file.parent_path(), std::vector<std::string>{name, name + "-wal", name + "-shm"});
    if (has_moved(*database)) throw ResultsGone("'{}' was replaced while it was opened", file.string());
  }

  void store_experiment() const {
    const std::string canonical = experiment.canonical.dump();
    SQLite::Statement insert(
        *database, "INSERT INTO experiment (one, id, canonical, canonical_sha256, build) VALUES (1, ?, ?, ?, ?)");
    SQLite::bind(insert, experiment.id, canonical, sha256_hex(canonical), std::string(build_id()));
    insert.exec();
  }

  /// A relay that goes on without a lost agent cannot be flown again in the same way, so its first record counts.
  [[nodiscard]] bool may_differ(const FlightKey& key) const {
    return experiment.on_agent_loss == experiment::OnAgentLoss::failover && !experiment.agent(key.agent).crew.empty();
  }

  Stored add(const FlightKey& key, std::string_view trace, std::string_view memory) {
    const std::optional<std::string> before = flights.digest(key);
    const std::uint32_t lineages = experiment.agent(key.agent).lineages();
    if ((lineages > 0) == memory.empty())
      throw IntegrityError(
          "condition {}, trial {}, agent '{}': {}", key.condition, key.trial, key.agent,
          memory.empty() ? "its memory for the next flight is missing" : "this agent has no memory to keep");
    const std::string digest = sha256_hex(trace);
    if (before) {
      if (*before == digest || may_differ(key)) return Stored::already_there;
      throw IntegrityError(
          "condition {}, trial {}, agent '{}' was flown twice with different results (digests {} and {}); equal "
          "flights must be equal: are builds or machines mixed in this run?",
          key.condition, key.trial, key.agent, *before, digest);
    }
    flights.insert({key, flights.measure(key.condition, trace), digest}, trace);
    if (lineages > 0) store_memory(key, lineages, memory);
    return Stored::added;
  }

  void store_memory(const FlightKey& key, std::uint32_t lineages, std::string_view memory) const {
    SQLite::Statement row(
        *database,
        "INSERT INTO memory (condition, agent, lineage, trial, digest, bytes) VALUES (?, ?, ?, ?, ?, ?) ON CONFLICT DO "
        "UPDATE SET trial = excluded.trial, digest = excluded.digest, bytes = excluded.bytes WHERE excluded.trial > "
        "memory.trial");
    SQLite::bind(row, key.condition, key.agent, key.trial % lineages, key.trial, memory_digest(key, memory));
    row.bindNoCopy(6, memory.data(), static_cast<int>(memory.size()));
    row.exec();
  }

  void for_each_flight(const std::function<void(FlightSummary)>& visit) const {
    with_errors_of(file, [&] { flights.visit(std::numeric_limits<std::int64_t>::min(), -1, visit); });
  }
};

ResultStore::ResultStore(std::unique_ptr<State> state) : state_(std::move(state)) {}
ResultStore::ResultStore(ResultStore&&) noexcept = default;
ResultStore::~ResultStore() = default;

ResultStore ResultStore::open_for_writing(const std::filesystem::path& dir, const Experiment& experiment) {
  MadeResults made = make_folder(dir);
  std::unique_ptr<State> state;
  try {
    state = std::make_unique<State>(dir, Access::write);
    made.database = state->is_new;
    state->experiment = experiment;
    with_errors_of(state->file, [&] { state->begin_writing(); });
    if (!std::filesystem::exists(dir / "experiment.json"))
      write_file(dir / "experiment.json", resolved_file(experiment));
    state->begin_watch();
  } catch (const std::exception&) {
    state.reset();
    take_back(made);
    throw;
  }
  state->made = std::move(made);
  return ResultStore(std::move(state));
}

bool ResultStore::exists(const std::filesystem::path& dir) {
  return std::filesystem::is_regular_file(dir / database_name);
}

ResultStore ResultStore::open_for_reading(const std::filesystem::path& dir) {
  if (!exists(dir))
    throw InputError("'{}' is no result folder: it has no {}; give the folder that was --out of a run", dir.string(),
                     database_name);
  auto state = std::make_unique<State>(dir, Access::read);
  const std::string stored = with_errors_of(state->file, [&] { return state->stored_canonical(); });
  if (stored.empty()) throw InputError("'{}' holds no results yet", dir.string());
  state->experiment = experiment::parse(stored, state->file.string());
  return ResultStore(std::move(state));
}

const Experiment& ResultStore::experiment() const noexcept {
  return state_->experiment;
}

const MadeResults& ResultStore::made() const noexcept {
  return state_->made;
}

void ResultStore::check_in_place() const {
  if (state_->watch) state_->watch->check();
}

Stored ResultStore::add(const FlightKey& key, std::string_view encoded_trace, std::string_view memory) {
  if (state_->batch_open) return with_errors_of(state_->file, [&] { return state_->add(key, encoded_trace, memory); });
  Stored stored{};
  batch([&] { stored = add(key, encoded_trace, memory); });
  return stored;
}

void ResultStore::batch(const std::function<void()>& work) {
  if (state_->batch_open) throw std::logic_error("a batch inside a batch");
  struct Closing {
    bool& open;
    ~Closing() { open = false; }
  } closing{state_->batch_open};
  try {
    with_errors_of(state_->file, [&] {
      SQLite::Transaction transaction(*state_->database, SQLite::TransactionBehavior::IMMEDIATE);
      state_->batch_open = true;
      work();
      transaction.commit();
    });
  } catch (const std::exception&) {
    check_in_place();  // if it throws, its error names the reason
    throw;
  }
  check_in_place();
}

void ResultStore::sign(const ProcessName& writer) {
  with_errors_of(state_->file, [&] {
    SQLite::Statement row(
        *state_->database,
        "INSERT OR REPLACE INTO writer (one, incarnation, host, pid, since_s) VALUES (1, ?, ?, ?, ?)");
    SQLite::bind(row, std::bit_cast<std::int64_t>(writer.incarnation), writer.host, writer.pid,
                 static_cast<std::int64_t>(writer.since_s));
    row.exec();
  });
}

std::optional<ProcessName> ResultStore::writer() const {
  return with_errors_of(state_->file, [&]() -> std::optional<ProcessName> {
    if (!state_->database->tableExists("writer")) return std::nullopt;  // an older version wrote it
    SQLite::Statement row(*state_->database, "SELECT incarnation, host, pid, since_s FROM writer");
    if (!row.executeStep()) return std::nullopt;
    return ProcessName{std::bit_cast<std::uint64_t>(row.getColumn(0).getInt64()), row.getColumn(1).getString(),
                       row.getColumn(2).getUInt(), static_cast<std::uint64_t>(row.getColumn(3).getInt64())};
  });
}

bool ResultStore::holds(const FlightKey& key) const {
  return with_errors_of(state_->file, [&] { return state_->flights.digest(key).has_value(); });
}

bool ResultStore::in_place() const {
  return !has_moved(*state_->database);
}

std::uint64_t ResultStore::count() const {
  return with_errors_of(state_->file, [&] {
    return static_cast<std::uint64_t>(state_->database->execAndGet("SELECT count(*) FROM flight").getInt64());
  });
}

std::set<FlightKey> ResultStore::keys() const {
  std::set<FlightKey> keys;
  state_->for_each_flight([&](FlightSummary flight) { keys.insert(std::move(flight.key)); });
  return keys;
}

void ResultStore::for_each_flight(const std::function<void(const FlightSummary&)>& visit) const {
  state_->for_each_flight(visit);
}

std::optional<std::int64_t> ResultStore::visit_part(std::int64_t from, std::uint32_t limit,
                                                    const std::function<void(const FlightSummary&)>& visit) const {
  const auto last = with_errors_of(state_->file, [&] { return state_->flights.visit(from, limit, visit); });
  return last ? std::optional(*last + 1) : std::nullopt;
}

std::vector<FlightSummary> ResultStore::flights() const {
  std::vector<FlightSummary> flights;
  state_->for_each_flight([&](FlightSummary flight) { flights.push_back(std::move(flight)); });
  return flights;
}

std::string ResultStore::trace(const FlightKey& key) const {
  std::optional<std::string> bytes = with_errors_of(state_->file, [&] { return state_->flights.trace(key); });
  if (!bytes)
    throw InputError("condition {}, trial {}, agent '{}' is not among the results in '{}'", key.condition, key.trial,
                     key.agent, state_->file.parent_path().string());
  return *std::move(bytes);
}

std::optional<std::string> ResultStore::memory(const FlightKey& key) const {
  const std::uint32_t lineages = state_->experiment.agent(key.agent).lineages();
  if (lineages == 0) return std::nullopt;
  return with_errors_of(state_->file, [&]() -> std::optional<std::string> {
    SQLite::Statement query(*state_->database,
                            "SELECT bytes, digest FROM memory WHERE condition = ? AND agent = ? AND lineage = ? AND "
                            "trial = ?");
    SQLite::bind(query, key.condition, key.agent, key.trial % lineages, key.trial);
    if (!query.executeStep()) return std::nullopt;
    std::string bytes = query.getColumn(0).getString();
    if (memory_digest(key, bytes) != query.getColumn(1).getString())
      refuse_damaged(state_->file,
                     fmt::format("the memory of agent '{}' after trial {} was altered", key.agent, key.trial));
    return bytes;
  });
}

std::string ResultStore::digest() const {
  Digest digest;
  state_->for_each_flight([&](const FlightSummary& flight) {
    digest.add(fmt::format("{} {} {} {}\n", flight.key.condition, flight.key.trial, flight.key.agent, flight.digest));
  });
  return digest.hex();
}

std::string Shortfall::text(const Experiment& experiment) const {
  std::string names;
  for (const FlightKey& key : first)
    names += fmt::format("{}agent {} in trial {} of condition {} ({})", names.empty() ? "" : ", ", key.agent, key.trial,
                         key.condition, experiment.conditions.at(key.condition).name);
  const std::uint64_t total =
      std::uint64_t{experiment.trials} * experiment.conditions.size() * experiment.agents.size();
  const std::string more = flights > first.size() ? fmt::format(" and {} more", flights - first.size()) : "";
  return fmt::format("{} of {} flights are missing: {}{}", flights, total, names, more);
}

Shortfall shortfall(const ResultStore& results, std::size_t named) {
  const Experiment& experiment = results.experiment();
  const std::uint64_t agents = experiment.agents.size();
  Shortfall missing;
  std::uint64_t next = 0;  // in canonical order
  const auto miss_until = [&](std::uint64_t number) {
    missing.flights += number - next;
    for (; next < number && missing.first.size() < named; ++next) {
      const std::uint64_t trial = next / agents;
      missing.first.push_back({static_cast<std::uint32_t>(trial / experiment.trials),
                               static_cast<std::uint32_t>(trial % experiment.trials),
                               experiment.agents[next % agents].name});
    }
    next = number;
  };
  results.for_each_flight([&](const FlightSummary& flight) {
    const auto number = static_cast<std::uint64_t>(flight_id(experiment, flight.key));
    miss_until(number);
    next = number + 1;
  });
  miss_until(std::uint64_t{experiment.trials} * experiment.conditions.size() * agents);
  return missing;
}

nlohmann::ordered_json summarise(const ResultStore& results) {
  return experiment::summarise(results.experiment(), results.flights(), build_id());
}

void write_summary(const std::filesystem::path& dir) {
  const nlohmann::ordered_json summary = summarise(ResultStore::open_for_reading(dir));
  write_file(dir / "summary.json", summary.dump(2) + "\n");
  write_file(dir / "summary.csv", experiment::summary_csv(summary));
}

}  // namespace aloft::store
