#include "common/store/result_store.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <stdexcept>

#include "common/base/build_info.hpp"
#include "common/base/digest.hpp"
#include "common/base/error.hpp"
#include "common/base/json_text.hpp"
#include "common/base/write_file.hpp"
#include "common/experiment/identity.hpp"
#include "common/experiment/summary.hpp"
#include "common/store/database.hpp"

namespace aloft::store {
namespace {

using experiment::Experiment;
using experiment::FlightKey;

std::size_t agent_index(const Experiment& experiment, std::string_view name) {
  const auto& agents = experiment.agents;
  const auto at = std::find_if(agents.begin(), agents.end(), [&](const auto& agent) { return agent.name == name; });
  return static_cast<std::size_t>(at - agents.begin());
}

/// Position in canonical order.
std::int64_t row_id(const Experiment& experiment, const FlightKey& key) {
  const std::size_t agent = agent_index(experiment, key.agent);
  if (key.condition >= experiment.conditions.size() || key.trial >= experiment.trials ||
      agent == experiment.agents.size())
    throw std::logic_error(fmt::format("experiment '{}' has no flight (condition {}, trial {}, agent '{}')",
                                       experiment.name, key.condition, key.trial, key.agent));
  const std::uint64_t trial = std::uint64_t{key.condition} * experiment.trials + key.trial;
  return static_cast<std::int64_t>(trial * experiment.agents.size() + agent);
}

std::int64_t seal_of(std::int64_t id, const FlightSummary& flight) {
  const std::string row =
      fmt::format("{} {} {} {} {} {} {} {} {} {}", id, flight.key.condition, flight.key.trial, flight.key.agent,
                  std::bit_cast<std::uint64_t>(flight.qos_mean), std::bit_cast<std::uint64_t>(flight.height_mean_m),
                  flight.height_changes, std::bit_cast<std::uint64_t>(flight.energy_j),
                  flight.handovers ? static_cast<int>(*flight.handovers) : -1, flight.digest);
  return std::bit_cast<std::int64_t>(sha256_id(row));
}

/// Of a memory and whose it is: it must not be taken for that of another flight either.
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
        lock(access == Access::write ? std::make_unique<WriterLock>(dir) : nullptr),
        is_new(access == Access::write && !std::filesystem::exists(file)),
        database(open_database(file, access)) {}

  std::filesystem::path file;
  std::unique_ptr<WriterLock> lock;
  bool is_new;
  std::unique_ptr<SQLite::Database> database;
  Experiment experiment;
  MadeResults made;
  std::optional<FolderWatch> watch;  // of who writes
  bool batch_open = false;
  // Statements that every flight needs, prepared once.
  std::unique_ptr<SQLite::Statement> find_digest;
  std::unique_ptr<SQLite::Statement> insert_flight;
  std::unique_ptr<SQLite::Statement> insert_trace;
  std::unique_ptr<SQLite::Statement> keep_memory;

  void prepare_reading() {
    find_digest = std::make_unique<SQLite::Statement>(*database, "SELECT digest FROM flight WHERE id = ?");
  }

  void prepare_writing() {
    prepare_reading();
    insert_flight =
        std::make_unique<SQLite::Statement>(*database, "INSERT INTO flight VALUES (?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?)");
    insert_trace = std::make_unique<SQLite::Statement>(*database, "INSERT INTO trace VALUES (?, ?)");
    keep_memory = std::make_unique<SQLite::Statement>(
        *database,
        "INSERT INTO memory VALUES (?, ?, ?, ?, ?, ?) ON CONFLICT DO UPDATE SET trial = excluded.trial, "
        "digest = excluded.digest, bytes = excluded.bytes WHERE excluded.trial > memory.trial");
  }

  /// The canonical experiment in the database; empty if there is none yet.
  [[nodiscard]] std::string stored_canonical() const {
    SQLite::Statement query(*database, "SELECT canonical, canonical_sha256 FROM experiment");
    if (!query.executeStep()) return {};
    std::string canonical = query.getColumn(0).getString();
    if (sha256_hex(canonical) != query.getColumn(1).getString()) refuse_damaged(file, "the experiment was altered");
    return canonical;
  }

  void begin_writing();
  void check_memories() const;
  void begin_watch();

  void store_experiment() const {
    const std::string canonical = experiment.canonical.dump();
    SQLite::Statement insert(*database, "INSERT INTO experiment VALUES (1, ?, ?, ?, ?)");
    insert.bind(1, experiment.id);
    insert.bind(2, canonical);
    insert.bind(3, sha256_hex(canonical));
    insert.bind(4, std::string(build_id()));
    insert.exec();
  }

  Stored add(const FlightKey& key, std::string_view trace, std::string_view memory);
  [[nodiscard]] bool may_differ(const FlightKey& key) const;
  void store_memory(const FlightKey& key, std::uint32_t lineages, std::string_view memory) const;
  [[nodiscard]] FlightSummary summary_at(SQLite::Statement& row) const;
  template <typename Visit>
  void for_each_flight(Visit&& visit) const;
};

/// A relay that goes on without whoever is lost cannot be flown again the same way; its first record counts.
bool ResultStore::State::may_differ(const FlightKey& key) const {
  return experiment.on_agent_loss == experiment::OnAgentLoss::failover && !experiment.agent(key.agent).crew.empty();
}

Stored ResultStore::State::add(const FlightKey& key, std::string_view trace, std::string_view memory) {
  const std::int64_t id = row_id(experiment, key);
  const std::uint32_t lineages = experiment.agent(key.agent).lineages();
  if ((lineages > 0) == memory.empty())
    throw IntegrityError(
        fmt::format("condition {}, trial {}, agent '{}': {}", key.condition, key.trial, key.agent,
                    memory.empty() ? "its memory for the next flight is missing" : "this agent has no memory to keep"));
  const std::string digest = sha256_hex(trace);
  find_digest->reset();
  find_digest->bind(1, id);
  if (find_digest->executeStep()) {
    const std::string before = find_digest->getColumn(0).getString();
    find_digest->reset();
    if (before == digest || may_differ(key)) return Stored::already_there;
    throw IntegrityError(fmt::format(
        "condition {}, trial {}, agent '{}' was flown twice with different results (digests {} and {}); equal flights "
        "must be equal: are builds or machines mixed in this run?",
        key.condition, key.trial, key.agent, before, digest));
  }
  find_digest->reset();
  const flight::FlightRecord record = decode_trace(trace);
  if (record.steps.empty()) throw IntegrityError("a flight without steps is no result");
  const FlightSummary flight{key,
                             record.qos_mean(),
                             record.height_mean_m(),
                             record.height_changes(),
                             record.energy_j(experiment.costs_in(experiment.conditions.at(key.condition))),
                             record.handovers(),
                             digest};

  SQLite::Statement& row = *insert_flight;
  row.reset();
  row.bind(1, id);
  row.bind(2, key.condition);
  row.bind(3, key.trial);
  row.bind(4, key.agent);
  row.bind(5, flight.qos_mean);
  row.bind(6, flight.height_mean_m);
  row.bind(7, flight.height_changes);
  row.bind(8, flight.energy_j);
  if (flight.handovers)
    row.bind(9, *flight.handovers);
  else
    row.bind(9);
  row.bind(10, digest);
  row.bind(11, seal_of(id, flight));
  row.exec();
  insert_trace->reset();
  insert_trace->bind(1, id);
  insert_trace->bindNoCopy(2, trace.data(), static_cast<int>(trace.size()));
  insert_trace->exec();
  if (lineages > 0) store_memory(key, lineages, memory);
  return Stored::added;
}

void ResultStore::State::store_memory(const FlightKey& key, std::uint32_t lineages, std::string_view memory) const {
  SQLite::Statement& row = *keep_memory;
  row.reset();
  row.bind(1, key.condition);
  row.bind(2, key.agent);
  row.bind(3, key.trial % lineages);
  row.bind(4, key.trial);
  row.bind(5, memory_digest(key, memory));
  row.bindNoCopy(6, memory.data(), static_cast<int>(memory.size()));
  row.exec();
  row.reset();
}

FlightSummary ResultStore::State::summary_at(SQLite::Statement& row) const {
  FlightSummary flight;
  flight.key = {row.getColumn(1).getUInt(), row.getColumn(2).getUInt(), row.getColumn(3).getString()};
  flight.qos_mean = row.getColumn(4).getDouble();
  flight.height_mean_m = row.getColumn(5).getDouble();
  flight.height_changes = row.getColumn(6).getUInt();
  flight.energy_j = row.getColumn(7).getDouble();
  if (!row.getColumn(8).isNull()) flight.handovers = row.getColumn(8).getUInt();
  flight.digest = row.getColumn(9).getString();
  const std::int64_t id = row.getColumn(0).getInt64();
  if (seal_of(id, flight) != row.getColumn(10).getInt64())
    refuse_damaged(file, fmt::format("row {} of table flight was altered", id));
  return flight;
}

template <typename Visit>
void ResultStore::State::for_each_flight(Visit&& visit) const {
  with_errors_of(file, [&] {
    SQLite::Statement rows(*database, "SELECT * FROM flight ORDER BY id");
    while (rows.executeStep()) visit(summary_at(rows));
  });
}

ResultStore::ResultStore(std::unique_ptr<State> state) : state_(std::move(state)) {}
ResultStore::ResultStore(ResultStore&&) noexcept = default;
ResultStore::~ResultStore() = default;

/// Refuses the results of another experiment before anything is written.
void ResultStore::State::begin_writing() {
  const std::string stored = stored_canonical();
  if (!stored.empty()) {
    if (const nlohmann::json there = parse_json(stored, file.string()); experiment::id_of(there) != experiment.id)
      throw InputError(
          fmt::format("'{}' holds the results of another experiment: {}. Name another folder with --out, or move this "
                      "one away",
                      file.parent_path().string(), experiment::describe_differences(there, experiment.canonical)));
  }
  update_format(*database);
  if (stored.empty()) store_experiment();
  check_memories();
  prepare_writing();
}

/// Without the memory that it ended with, a lineage cannot go on.
void ResultStore::State::check_memories() const {
  for (const agents::AgentSpec& agent : experiment.agents) {
    if (agent.lineages() == 0) continue;
    SQLite::Statement lost(
        *database,
        "SELECT condition, last FROM (SELECT condition, trial % ?1 AS lineage, max(trial) AS last FROM flight "
        "WHERE agent = ?2 GROUP BY condition, lineage) AS latest WHERE NOT EXISTS (SELECT 1 FROM memory WHERE "
        "memory.condition = latest.condition AND memory.agent = ?2 AND memory.lineage = latest.lineage AND "
        "memory.trial = last) LIMIT 1");
    lost.bind(1, agent.lineages());
    lost.bind(2, agent.name);
    if (lost.executeStep())
      refuse_damaged(file, fmt::format("the memory of agent '{}' after condition {}, trial {} was removed", agent.name,
                                       lost.getColumn(0).getInt64(), lost.getColumn(1).getInt64()));
  }
}

/// SQLite's log and its index are there as long as it is open. That the folder was replaced while it was opened, SQLite
/// itself remembers.
void ResultStore::State::begin_watch() {
  const std::string name = database_name;
  watch.emplace(file.parent_path(), std::vector<std::string>{name, name + "-wal", name + "-shm"});
  if (has_moved(*database)) throw ResultsGone(fmt::format("'{}' was replaced while it was opened", file.string()));
}

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
    throw InputError(fmt::format("'{}' is no result folder: it has no {}; give the folder that was --out of a run",
                                 dir.string(), database_name));
  auto state = std::make_unique<State>(dir, Access::read);
  const std::string stored = with_errors_of(state->file, [&] { return state->stored_canonical(); });
  if (stored.empty()) throw InputError(fmt::format("'{}' holds no results yet", dir.string()));
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
    check_in_place();  // then that is the reason
    throw;
  }
  check_in_place();
}

void ResultStore::sign(const ProcessName& writer) {
  with_errors_of(state_->file, [&] {
    SQLite::Statement row(*state_->database, "INSERT OR REPLACE INTO writer VALUES (1, ?, ?, ?, ?)");
    row.bind(1, std::bit_cast<std::int64_t>(writer.incarnation));
    row.bind(2, writer.host);
    row.bind(3, writer.pid);
    row.bind(4, static_cast<std::int64_t>(writer.since_s));
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
  const std::int64_t id = row_id(state_->experiment, key);
  return with_errors_of(state_->file, [&] {
    if (!state_->find_digest) state_->prepare_reading();
    SQLite::Statement& row = *state_->find_digest;
    row.reset();
    row.bind(1, id);
    const bool found = row.executeStep();
    row.reset();
    return found;
  });
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
  return with_errors_of(state_->file, [&]() -> std::optional<std::int64_t> {
    SQLite::Statement rows(*state_->database, "SELECT * FROM flight WHERE id >= ? ORDER BY id LIMIT ?");
    rows.bind(1, from);
    rows.bind(2, limit);
    std::optional<std::int64_t> last;
    while (rows.executeStep()) {
      visit(state_->summary_at(rows));
      last = rows.getColumn(0).getInt64();
    }
    return last ? std::optional(*last + 1) : std::nullopt;
  });
}

std::vector<FlightSummary> ResultStore::flights() const {
  std::vector<FlightSummary> flights;
  state_->for_each_flight([&](FlightSummary flight) { flights.push_back(std::move(flight)); });
  return flights;
}

std::string ResultStore::trace(const FlightKey& key) const {
  const std::int64_t id = row_id(state_->experiment, key);
  return with_errors_of(state_->file, [&] {
    SQLite::Statement query(
        *state_->database,
        "SELECT flight.*, bytes FROM flight JOIN trace ON trace.flight = flight.id WHERE flight.id = ?");
    query.bind(1, id);
    if (!query.executeStep())
      throw InputError(fmt::format("condition {}, trial {}, agent '{}' is not among the results in '{}'", key.condition,
                                   key.trial, key.agent, state_->file.parent_path().string()));
    const FlightSummary flight = state_->summary_at(query);
    std::string bytes = query.getColumn(11).getString();
    if (sha256_hex(bytes) != flight.digest)
      refuse_damaged(state_->file, fmt::format("row {} of table trace was altered", id));
    return bytes;
  });
}

std::optional<std::string> ResultStore::memory(const FlightKey& key) const {
  const std::uint32_t lineages = state_->experiment.agent(key.agent).lineages();
  if (lineages == 0) return std::nullopt;
  return with_errors_of(state_->file, [&]() -> std::optional<std::string> {
    SQLite::Statement query(*state_->database,
                            "SELECT bytes, digest FROM memory WHERE condition = ? AND agent = ? AND lineage = ? AND "
                            "trial = ?");
    query.bind(1, key.condition);
    query.bind(2, key.agent);
    query.bind(3, key.trial % lineages);
    query.bind(4, key.trial);
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
    const auto number = static_cast<std::uint64_t>(row_id(experiment, flight.key));
    miss_until(number);
    next = number + 1;
  });
  miss_until(std::uint64_t{experiment.trials} * experiment.conditions.size() * agents);
  return missing;
}

nlohmann::ordered_json summarise(const ResultStore& results) {
  std::vector<experiment::FlightScore> scores;
  for (FlightSummary& flight : results.flights())
    scores.push_back({std::move(flight.key), flight.qos_mean, flight.height_mean_m, flight.height_changes,
                      flight.energy_j, flight.handovers});
  return experiment::summarise(results.experiment(), scores, build_id());
}

void write_summary(const std::filesystem::path& dir) {
  const nlohmann::ordered_json summary = summarise(ResultStore::open_for_reading(dir));
  write_file(dir / "summary.json", summary.dump(2) + "\n");
  write_file(dir / "summary.csv", experiment::summary_csv(summary));
}

}  // namespace aloft::store
