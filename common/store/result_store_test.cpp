#include "common/store/result_store.hpp"

#include <SQLiteCpp/SQLiteCpp.h>
#include <sys/mount.h>
#include <sys/wait.h>
#include <unistd.h>

#include <catch2/catch.hpp>
#include <fstream>
#include <functional>

#include "common/base/build_info.hpp"
#include "common/base/digest.hpp"
#include "common/base/error.hpp"
#include "common/base/random.hpp"
#include "common/base/read_file.hpp"
#include "tests/own_mounts.hpp"

using namespace aloft;
using namespace aloft::store;
using Catch::Contains;
using experiment::Experiment;
using experiment::FlightKey;

namespace {

class Folder {
 public:
  Folder() {
    std::string pattern = (std::filesystem::temp_directory_path() / "aloft-store-test-XXXXXX").string();
    if (mkdtemp(pattern.data()) == nullptr) throw std::runtime_error("cannot make a scratch folder");
    path_ = pattern;
  }
  ~Folder() { std::filesystem::remove_all(path_); }
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;
  [[nodiscard]] std::filesystem::path operator/(const char* name) const { return path_ / name; }
  [[nodiscard]] const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

Experiment small(std::uint64_t seed = 1) {
  return experiment::parse(R"({"name": "small", "trials": 20, "world": {"bs_density_per_km2": [1, 5]},
                               "agents": ["min-height", "constant-120"], "seed": )" +
                               std::to_string(seed) + "}",
                           "test");
}

/// Trials 0, 2, 4, ... and 1, 3, 5, ... of the DQN are two lineages.
Experiment remembering() {
  return experiment::parse(R"({"name": "remembering", "trials": 20, "world": {"bs_density_per_km2": [1, 5]},
      "agents": ["min-height", {"type": "dqn", "memory": "lifelong", "lineages": 2}]})",
                           "test");
}

/// A flight of three steps at 40, 50 and 50 m with these qualities: mean height 140/3, one change.
std::string flight_with(double qos, std::uint32_t steps = 3) {
  flight::FlightRecord record;
  record.height_start_m = 40.0;
  record.pilots = {"someone"};
  for (std::uint32_t step = 1; step <= steps; ++step)
    record.steps.push_back(
        {step, agents::Action::up, 10.0 * step, 0.0, step == 1 ? 40.0 : 50.0, 3, 1.0, qos, qos, 0, {}});
  return encode_trace(record);
}

const FlightKey first{0, 0, "min-height"};
const FlightKey second{0, 0, "constant-120"};
const FlightKey later{1, 7, "min-height"};

void run_sql(const std::filesystem::path& dir, const std::string& sql) {
  SQLite::Database database((dir / "results.sqlite").string(), SQLite::OPEN_READWRITE);
  REQUIRE(database.exec(sql) == 1);
}

}  // namespace

TEST_CASE("flights come back in canonical order, whatever the order of storing") {
  const Folder folder;
  auto results = ResultStore::open_for_writing(folder / "out", small());
  CHECK(results.add(later, flight_with(3.0)) == Stored::added);
  CHECK(results.add(second, flight_with(2.0)) == Stored::added);
  CHECK(results.add(first, flight_with(1.0)) == Stored::added);
  const auto flights = results.flights();
  REQUIRE(flights.size() == 3);
  CHECK(flights[0].key == first);
  CHECK(flights[1].key == second);  // the experiment's order of agents, not the alphabet's
  CHECK(flights[2].key == later);
  CHECK(flights[2].metrics["qos_mean"] == 3.0);
  CHECK(flights[2].metrics["height_mean_m"].value() == Approx(140.0 / 3.0));
  CHECK(flights[2].metrics["height_changes"] == 1.0);
  CHECK(flights[2].metrics["energy_j"].value() ==
        Approx(3 * 126.029 + 285.714).epsilon(1e-5));  // three seconds, 10 m of climb
  CHECK(flights[2].metrics["handovers"] == 0.0);
  CHECK(flights[2].digest == sha256_hex(flight_with(3.0)));
  CHECK(results.keys() == std::set<FlightKey>{first, second, later});
  CHECK(results.trace(later) == flight_with(3.0));
}

TEST_CASE("flights can be visited in parts, while others are stored") {
  const Folder folder;
  auto results = ResultStore::open_for_writing(folder / "out", small());
  for (const FlightKey& key : {first, second, later}) (void)results.add(key, flight_with(1.0));
  const auto reader = ResultStore::open_for_reading(folder / "out");
  std::vector<FlightKey> seen;
  const auto visit = [&](const FlightSummary& flight) { seen.push_back(flight.key); };
  const auto rest = reader.visit_part(0, 2, visit);
  REQUIRE(rest);
  CHECK(seen == std::vector{first, second});
  const FlightKey last{1, 19, "constant-120"};
  (void)results.add(last, flight_with(1.0));
  (void)results.add({0, 1, "min-height"}, flight_with(1.0));
  const auto end = reader.visit_part(*rest, 10, visit);
  CHECK(seen == std::vector{first, second, {0, 1, "min-height"}, later, last});
  REQUIRE(end);
  CHECK_FALSE(reader.visit_part(*end, 10, visit));
  CHECK(seen.size() == 5);
}

TEST_CASE("the digest depends on what was flown, not on the order or number of sessions") {
  const Folder folder;
  std::string one_go;
  {
    auto results = ResultStore::open_for_writing(folder / "a", small());
    results.batch([&] {
      (void)results.add(first, flight_with(1.0));
      (void)results.add(later, flight_with(3.0));
    });
    one_go = results.digest();
  }
  { (void)ResultStore::open_for_writing(folder / "b", small()).add(later, flight_with(3.0)); }
  CHECK(ResultStore::open_for_reading(folder / "b").digest() != one_go);
  { (void)ResultStore::open_for_writing(folder / "b", small()).add(first, flight_with(1.0)); }
  CHECK(ResultStore::open_for_reading(folder / "b").digest() == one_go);
  // By hand: a line per flight.
  CHECK(one_go == sha256_hex("0 0 min-height " + sha256_hex(flight_with(1.0)) + "\n1 7 min-height " +
                             sha256_hex(flight_with(3.0)) + "\n"));
}

TEST_CASE("storing a flight again is a no-op, storing it with another result is an error") {
  const Folder folder;
  auto results = ResultStore::open_for_writing(folder / "out", small());
  CHECK(results.add(first, flight_with(1.0)) == Stored::added);
  CHECK(results.add(first, flight_with(1.0)) == Stored::already_there);
  CHECK_THROWS_AS(results.add(first, flight_with(1.5)), IntegrityError);
  CHECK_THROWS_WITH(results.add(first, flight_with(1.5)), Contains("condition 0, trial 0, agent 'min-height'"));
  CHECK(results.flights().at(0).metrics["qos_mean"] == 1.0);
}

TEST_CASE("damaged traces, empty flights and flights that the experiment does not have are not stored") {
  const Folder folder;
  auto results = ResultStore::open_for_writing(folder / "out", small());
  CHECK_THROWS_AS(results.add(first, "not a trace"), IntegrityError);
  CHECK_THROWS_AS(results.add(first, flight_with(1.0, 0)), IntegrityError);
  CHECK_THROWS_AS(results.add({2, 0, "min-height"}, flight_with(1.0)), std::logic_error);
  CHECK_THROWS_AS(results.add({0, 20, "min-height"}, flight_with(1.0)), std::logic_error);
  CHECK_THROWS_AS(results.add({0, 0, "dqn"}, flight_with(1.0)), std::logic_error);
  CHECK(results.keys().empty());
}

TEST_CASE("a batch is stored as a whole or not at all") {
  const Folder folder;
  auto results = ResultStore::open_for_writing(folder / "out", small());
  CHECK_THROWS_AS(results.batch([&] {
    (void)results.add(first, flight_with(1.0));
    (void)results.add(second, "not a trace");
  }),
                  IntegrityError);
  CHECK(results.keys().empty());
  CHECK(results.add(first, flight_with(1.0)) == Stored::added);
  CHECK_THROWS_AS(results.batch([&] { results.batch([] {}); }), std::logic_error);
}

TEST_CASE("readers see what is committed while a writer goes on") {
  const Folder folder;
  auto results = ResultStore::open_for_writing(folder / "out", small());
  (void)results.add(first, flight_with(1.0));
  results.batch([&] {
    (void)results.add(second, flight_with(2.0));
    CHECK(ResultStore::open_for_reading(folder / "out").flights().size() == 1);
  });
  const auto reader = ResultStore::open_for_reading(folder / "out");
  CHECK(reader.flights().size() == 2);
  CHECK(reader.experiment().id == small().id);
  CHECK_THROWS_WITH(reader.trace(later), Contains("trial 7"));
}

TEST_CASE("a stored flight survives kill -9 of its writer") {
  const Folder folder;
  const pid_t child = fork();
  if (child == 0) {
    auto results = ResultStore::open_for_writing(folder / "out", small());
    (void)results.add(first, flight_with(1.0));
    results.batch([&] {
      (void)results.add(second, flight_with(2.0));
      kill(getpid(), SIGKILL);
    });
  }
  int status = 0;
  REQUIRE(waitpid(child, &status, 0) == child);
  REQUIRE(WIFSIGNALED(status));
  CHECK(ResultStore::open_for_reading(folder / "out").keys() == std::set<FlightKey>{first});
  auto results = ResultStore::open_for_writing(folder / "out", small());
  CHECK(results.add(second, flight_with(2.0)) == Stored::added);
}

TEST_CASE("experiment.json holds the resolved experiment and the build, and can be run again") {
  const Folder folder;
  { (void)ResultStore::open_for_writing(folder / "out", small()); }
  const std::string text = read_file(folder / "out" / "experiment.json");
  CHECK_THAT(text, Contains("\"los_ray\": \"published\"") &&
                       Contains("\"build\": \"" + std::string(aloft::build_id()) + "\""));
  CHECK(experiment::load(folder / "out" / "experiment.json").id == small().id);
  std::filesystem::remove(folder / "out" / "experiment.json");
  { (void)ResultStore::open_for_writing(folder / "out", small()); }
  CHECK(read_file(folder / "out" / "experiment.json") == text);
}

TEST_CASE("a folder with other results or other files is refused and left alone") {
  const Folder folder;
  { (void)ResultStore::open_for_writing(folder / "out", small(3)).add(first, flight_with(1.0)); }
  CHECK_THROWS_WITH(ResultStore::open_for_writing(folder / "out", small(4)),
                    Contains("another experiment: seed is 3 there and 4 here. Name another folder with --out"));
  CHECK(ResultStore::open_for_reading(folder / "out").flights().size() == 1);

  std::filesystem::create_directory(folder / "letters");
  std::ofstream(folder / "letters" / "dear.txt") << "Dear all";
  CHECK_THROWS_WITH(ResultStore::open_for_writing(folder / "letters", small()),
                    Contains("dear.txt") && Contains("--out"));
  CHECK_FALSE(std::filesystem::exists(folder / "letters" / "results.sqlite"));
  CHECK_THROWS_WITH(ResultStore::open_for_reading(folder / "letters"),
                    Contains("letters") && Contains("no result folder"));

  {
    SQLite::Database(folder / "foreign.sqlite", SQLite::OPEN_READWRITE | SQLite::OPEN_CREATE)
        .exec("CREATE TABLE t (x)");
  }
  std::filesystem::create_directory(folder / "foreign");
  std::filesystem::rename(folder / "foreign.sqlite", folder / "foreign" / "results.sqlite");
  CHECK_THROWS_WITH(ResultStore::open_for_writing(folder / "foreign", small()), Contains("another program"));
  CHECK_THROWS_AS(ResultStore::open_for_reading(folder / "foreign"), InputError);
}

TEST_CASE("a folder that cannot be written is refused") {
  const Folder folder;
  std::ofstream(folder / "file") << "x";
  CHECK_THROWS_AS(ResultStore::open_for_writing(folder / "file" / "below", small()), InputError);
  CHECK_THROWS_WITH(ResultStore::open_for_writing(folder / "file", small()), Contains("file") && Contains("--out"));
  CHECK_THROWS_AS(ResultStore::open_for_writing("/proc/aloft", small()), InputError);
}

TEST_CASE("two writers at once are refused") {
  const Folder folder;
  const auto results = ResultStore::open_for_writing(folder / "out", small());
  CHECK_THROWS_WITH(ResultStore::open_for_writing(folder / "out", small()), Contains("another Aloft process"));
}

TEST_CASE("an interrupted creation is completed") {
  const Folder folder;
  std::filesystem::create_directory(folder / "out");
  std::ofstream(folder / "out" / "results.sqlite").flush();  // empty
  CHECK(ResultStore::open_for_writing(folder / "out", small()).keys().empty());
}

TEST_CASE("altered rows are refused with a hint") {
  const Folder folder;
  { (void)ResultStore::open_for_writing(folder / "out", small()).add(first, flight_with(1.0)); }
  const auto dir = folder / "out";
  SECTION("a number") {
    run_sql(dir, "UPDATE flight SET qos_mean = 2.0");
  }
  SECTION("a trial") {
    run_sql(dir, "UPDATE flight SET trial = 1");
  }
  SECTION("a position") {
    run_sql(dir, "UPDATE flight SET id = 3");
    run_sql(dir, "UPDATE trace SET flight = 3");
  }
  SECTION("a digest") {
    run_sql(dir, "UPDATE flight SET digest = 'x'");
  }
  const auto results = ResultStore::open_for_reading(dir);
  CHECK_THROWS_AS(results.flights(), IntegrityError);
  CHECK_THROWS_AS(results.keys(), IntegrityError);
  CHECK_THROWS_AS(results.digest(), IntegrityError);
  CHECK_THROWS_WITH(results.flights(), Contains("results.sqlite") && Contains("Restore"));
}

TEST_CASE("an altered trace or experiment is refused") {
  const Folder folder;
  { (void)ResultStore::open_for_writing(folder / "out", small()).add(first, flight_with(1.0)); }
  run_sql(folder / "out", "UPDATE trace SET bytes = substr(bytes, 1, 20)");
  CHECK_THROWS_AS(ResultStore::open_for_reading(folder / "out").trace(first), IntegrityError);
  run_sql(folder / "out", "UPDATE experiment SET canonical = replace(canonical, 'small', 'smell')");
  CHECK_THROWS_AS(ResultStore::open_for_reading(folder / "out"), IntegrityError);
  CHECK_THROWS_AS(ResultStore::open_for_writing(folder / "out", small()), IntegrityError);
}

TEST_CASE("rows that were removed are noticed by readers and writers, with a hint") {
  const Folder folder;
  const auto dir = folder / "out";
  {
    auto results = ResultStore::open_for_writing(dir, remembering());
    for (std::uint32_t trial = 0; trial < 4; ++trial) {
      (void)results.add({0, trial, "min-height"}, flight_with(1.0));
      (void)results.add({0, trial, "dqn"}, flight_with(2.0), "memory");
    }
  }
  std::string what;
  SECTION("a trace") {
    run_sql(dir, "DELETE FROM trace WHERE flight = 2");
    what = "the trace of row 2 of table flight was removed";
  }
  SECTION("a flight without its trace") {
    run_sql(dir, "DELETE FROM flight WHERE id = 2");
    what = "it holds 7 flights and 8 traces, and 8 were stored";
  }
  SECTION("a flight and its trace") {
    run_sql(dir, "DELETE FROM flight WHERE id = 2");
    run_sql(dir, "DELETE FROM trace WHERE flight = 2");
    what = "it holds 7 flights and 7 traces, and 8 were stored";
  }
  SECTION("a flight and its trace, replaced by another") {
    run_sql(dir, "UPDATE flight SET id = 17 WHERE id = 2");
    what = "the trace of row 17 of table flight was removed";
  }
  SECTION("the experiment") {
    run_sql(dir, "DELETE FROM experiment");
    what = "the experiment was removed";
  }
  SECTION("the count of the flights") {
    run_sql(dir, "DELETE FROM tally");
    what = "it holds 8 flights and 8 traces, and 0 were stored";
  }
  for (const auto& open :
       std::vector<std::function<void()>>{[&] { (void)ResultStore::open_for_reading(dir); },
                                          [&] { (void)ResultStore::open_for_writing(dir, remembering()); },
                                          [&] { (void)ResultStore::open_for_writing(dir, small()); }}) {
    CHECK_THROWS_AS(open(), IntegrityError);
    CHECK_THROWS_WITH(open(), Contains(what) && Contains("Restore the folder"));
  }
}

TEST_CASE("a removed memory is noticed by a writer, which needs it, but not by a reader") {
  const Folder folder;
  const auto dir = folder / "out";
  {
    auto results = ResultStore::open_for_writing(dir, remembering());
    for (std::uint32_t trial = 0; trial < 4; ++trial) (void)results.add({1, trial, "dqn"}, flight_with(2.0), "memory");
  }
  run_sql(dir, "DELETE FROM memory WHERE trial = 3");
  CHECK(ResultStore::open_for_reading(dir).flights().size() == 4);
  CHECK_THROWS_WITH(ResultStore::open_for_writing(dir, remembering()),
                    Contains("memory of agent 'dqn' after condition 1, trial 3 was removed"));
}

TEST_CASE("storing in a folder that was moved, removed or replaced is an error") {
  const Folder folder;
  const auto dir = folder / "out";
  const auto aside = folder / "aside";
  auto results = ResultStore::open_for_writing(dir, small());
  (void)results.add(first, flight_with(1.0));
  CHECK_NOTHROW(results.check_in_place());
  std::string what = "results.sqlite is gone";
  bool again = true;
  SECTION("the folder is moved, and moved back") {
    std::filesystem::rename(dir, aside);
    CHECK_THROWS_AS(results.add(second, flight_with(2.0)), ResultsGone);
    CHECK_THROWS_WITH(results.check_in_place(), Contains(what) && Contains("move it back"));
    std::filesystem::rename(aside, dir);
    CHECK_NOTHROW(results.check_in_place());
    again = false;
  }
  SECTION("the folder is removed") {
    std::filesystem::remove_all(dir);
  }
  SECTION("the folder is replaced by a copy") {
    std::filesystem::rename(dir, aside);
    std::filesystem::copy(aside, dir);
    what = "results.sqlite is another file now";
  }
  SECTION("the folder is replaced by a file") {
    std::filesystem::rename(dir, aside);
    std::ofstream(dir) << "x";
  }
  SECTION("the database is removed") {
    std::filesystem::remove(dir / "results.sqlite");
  }
  SECTION("the database is replaced") {
    std::filesystem::copy(dir / "results.sqlite", aside);
    std::filesystem::rename(aside, dir / "results.sqlite");
    what = "results.sqlite is another file now";
  }
  SECTION("its log is removed") {
    std::filesystem::remove(dir / "results.sqlite-wal");
    what = "results.sqlite-wal is gone";
  }
  if (!again) return;
  CHECK_THROWS_AS(results.add(second, flight_with(2.0)), ResultsGone);
  CHECK_THROWS_WITH(results.add(second, flight_with(2.0)), Contains(what) && Contains(dir.string()));
  CHECK_THROWS_WITH(results.check_in_place(), Contains(what) && Contains("the same command again"));
}

TEST_CASE("a reader that comes and goes does not look like a replaced folder") {
  const Folder folder;
  auto results = ResultStore::open_for_writing(folder / "out", small());
  const FolderWatch watch = watch_results(folder / "out");
  for (std::uint32_t trial = 0; trial < 20; ++trial) {
    CHECK(results.add({0, trial, "min-height"}, flight_with(1.0, 2000)) == Stored::added);
    const pid_t reader = fork();
    if (reader == 0) _exit(ResultStore::open_for_reading(folder / "out").flights().size() == trial + 1 ? 0 : 1);
    int status = 0;
    REQUIRE(waitpid(reader, &status, 0) == reader);
    CHECK(status == 0);
    CHECK_NOTHROW(watch.check());
  }
}

TEST_CASE("a run that is refused after it opened its folder takes back what it made, and nothing else") {
  const Folder folder;
  const auto dir = folder / "a" / "b" / "out";
  SECTION("everything was new") {
    const MadeResults made = ResultStore::open_for_writing(dir, small()).made();
    std::filesystem::create_directory(dir / "log");
    std::ofstream(dir / "log" / "w0.log") << "x";
    CHECK(made.folders.size() == 3);
    take_back(made);
    CHECK_FALSE(std::filesystem::exists(folder / "a"));
  }
  SECTION("the folder was there") {
    std::filesystem::create_directories(dir);
    const MadeResults made = ResultStore::open_for_writing(dir, small()).made();
    take_back(made);
    CHECK(std::filesystem::is_empty(dir));
  }
  SECTION("another process put a file there") {
    const MadeResults made = ResultStore::open_for_writing(dir, small()).made();
    std::ofstream(dir / "dear.txt") << "Dear all";
    take_back(made);
    CHECK(std::filesystem::exists(dir / "dear.txt"));
    CHECK_FALSE(std::filesystem::exists(dir / "results.sqlite"));
  }
  SECTION("a flight is stored") {
    auto results = std::make_unique<ResultStore>(ResultStore::open_for_writing(dir, small()));
    const MadeResults made = results->made();
    (void)results->add(first, flight_with(1.0));
    results.reset();
    take_back(made);
    CHECK(ResultStore::open_for_reading(dir).flights().size() == 1);
  }
  SECTION("the results were there, without a flight and without logs") {
    { (void)ResultStore::open_for_writing(dir, small()); }
    const MadeResults made = ResultStore::open_for_writing(dir, small()).made();
    std::filesystem::create_directory(dir / "log");
    take_back(made);
    CHECK(ResultStore::open_for_reading(dir).flights().empty());
    CHECK_FALSE(std::filesystem::exists(dir / "log"));
  }
  SECTION("another process writes there") {
    const MadeResults made = ResultStore::open_for_writing(dir, small()).made();
    const auto other = ResultStore::open_for_writing(dir, small());
    take_back(made);
    CHECK(ResultStore::open_for_reading(dir).flights().empty());
  }
}

TEST_CASE("opening that fails leaves nothing behind") {
  const Folder folder;
  std::ofstream(folder / "file") << "x";
  CHECK_THROWS_AS(ResultStore::open_for_writing(folder / "new" / ".." / "file" / "x", small()), InputError);
  CHECK_FALSE(std::filesystem::exists(folder / "new"));
  std::filesystem::create_directory(folder / "lost");
  std::ofstream(folder / "lost" / "experiment.json") << "{}";
  CHECK_THROWS_WITH(ResultStore::open_for_writing(folder / "lost", small()),
                    Contains("has lost its results.sqlite") && Contains("Put it back"));
  CHECK_FALSE(std::filesystem::exists(folder / "lost" / "results.sqlite"));
}

TEST_CASE("no flipped bit and no cut ever gives a wrong number") {
  const Folder folder;
  const auto file = folder / "out" / "results.sqlite";
  std::vector<double> true_qos;
  std::vector<std::string> true_digests;
  {
    auto results = ResultStore::open_for_writing(folder / "out", small());
    for (std::uint32_t trial = 0; trial < 20; ++trial)
      (void)results.add({0, trial, "min-height"}, flight_with(1.0 + trial, 40));
    for (const FlightSummary& flight : results.flights()) {
      true_qos.push_back(flight.metrics["qos_mean"].value());
      true_digests.push_back(flight.digest);
    }
  }
  const std::string intact = read_file(file);
  const auto still_right = [&](const std::string& bytes) {
    std::ofstream(file, std::ios::trunc) << bytes;
    try {
      const auto results = ResultStore::open_for_reading(folder / "out");
      std::vector<double> qos;
      std::vector<std::string> digests;
      for (const FlightSummary& flight : results.flights()) {
        qos.push_back(flight.metrics["qos_mean"].value());
        digests.push_back(sha256_hex(results.trace(flight.key)));
      }
      CHECK(qos == true_qos);
      CHECK(digests == true_digests);
      return true;
    } catch (const IntegrityError&) {
      return false;
    } catch (const InputError&) {  // a flip in the identity or the version of the format
      return false;
    }
  };
  REQUIRE(still_right(intact));
  RandomStream random(5, 0, "bit flips");
  int refused = 0;
  for (int i = 0; i < 1000; ++i) {
    const std::uint32_t bit = random.uniform_index(static_cast<std::uint32_t>(intact.size() * 8));
    std::string flipped = intact;
    flipped[bit / 8] = static_cast<char>(flipped[bit / 8] ^ (1 << (bit % 8)));
    refused += still_right(flipped) ? 0 : 1;
  }
  CHECK(refused > 300);  // the rest hit unused bytes
  for (std::size_t size = 1; size < intact.size(); size += intact.size() / 20)
    CHECK_FALSE(still_right(intact.substr(0, size)));
}

TEST_CASE("a stored trace or memory that is cut at any byte, or has any bit flipped, is refused with a hint") {
  const Folder folder;
  const FlightKey key{0, 0, "dqn"};
  std::string memory(100, '\0');
  for (std::size_t i = 0; i < memory.size(); ++i) memory[i] = static_cast<char>(37 * i);
  { (void)ResultStore::open_for_writing(folder / "out", remembering()).add(key, flight_with(1.0, 5), memory); }
  const auto results = ResultStore::open_for_reading(folder / "out");
  const std::string trace = results.trace(key);
  REQUIRE(results.memory(key) == memory);
  SQLite::Database database((folder / "out" / "results.sqlite").string(), SQLite::OPEN_READWRITE);
  database.exec("PRAGMA synchronous = OFF");
  const auto check_all_damages = [&](const char* update, const std::string& good, const auto& read) {
    SQLite::Statement put(database, update);
    const auto check_refused = [&](const std::string& damaged) {
      put.reset();
      put.bind(1, damaged.data(), static_cast<int>(damaged.size()));
      REQUIRE(put.exec() == 1);
      CHECK_THROWS_AS(read(), IntegrityError);
      CHECK_THROWS_WITH(read(), Contains("Restore the folder"));
    };
    for (std::size_t size = 0; size < good.size(); ++size) {
      INFO("cut to " << size << " bytes");
      check_refused(good.substr(0, size));
    }
    for (std::size_t bit = 0; bit < good.size() * 8; ++bit) {
      INFO("bit " << bit);
      std::string flipped = good;
      flipped[bit / 8] = static_cast<char>(flipped[bit / 8] ^ (1 << (bit % 8)));
      check_refused(flipped);
    }
  };
  check_all_damages("UPDATE trace SET bytes = ?", trace, [&] { return results.trace(key); });
  check_all_damages("UPDATE memory SET bytes = ?", memory, [&] { return results.memory(key); });
}

TEST_CASE("a full disk pauses storing; nothing stored is lost, and it goes on when there is room", "[needs-mounts]") {
  if (!test::own_mounts()) return;
  const Folder folder;
  REQUIRE(mount("tmpfs", folder.path().c_str(), "tmpfs", 0, "size=1m") == 0);
  struct Mounted {
    const Folder& at;
    ~Mounted() { umount2(at.path().c_str(), MNT_DETACH); }
  } const mounted{folder};
  std::set<FlightKey> stored;
  {
    auto results = ResultStore::open_for_writing(folder / "out", small());
    const auto store_one = [&](std::uint32_t trial) {
      (void)results.add({0, trial, "min-height"}, flight_with(1.0, 2000));  // 80 kB
      stored.insert({0, trial, "min-height"});
    };
    std::string refused;
    std::uint32_t trial = 0;
    try {
      while (trial < 20) store_one(trial++);
    } catch (const StoreFull& error) {
      refused = error.what();
    }
    CHECK_THAT(refused, Contains("full") && Contains("results.sqlite"));
    CHECK(stored.size() < 20);
    CHECK(results.keys() == stored);
    REQUIRE(mount("tmpfs", folder.path().c_str(), "tmpfs", MS_REMOUNT, "size=20m") == 0);
    for (--trial; trial < 20; ++trial) store_one(trial);
  }
  CHECK(ResultStore::open_for_reading(folder / "out").keys() == stored);
  CHECK(stored.size() == 20);
}

TEST_CASE("a summary of stored flights") {
  const Folder folder;
  auto results = ResultStore::open_for_writing(folder / "out", small());
  (void)results.add(first, flight_with(1.0));
  (void)results.add(second, flight_with(3.0));
  const nlohmann::ordered_json summary = summarise(results);
  CHECK(summary["experiment"] == "small");
  CHECK(summary["conditions"][0]["agents"]["constant-120"]["gain_over_min_height_mean"] == 2.0);
  CHECK(summary["conditions"][0]["parameters"]["bs_density_per_km2"] == 1);
  CHECK(summary["build"] == std::string(aloft::build_id()));
}

TEST_CASE("what an agent remembers is stored with its flight, the latest of each lineage; the digest is of flights") {
  const Folder folder;
  const std::string flight = flight_with(1.0);
  const auto dqn = [](std::uint32_t condition, std::uint32_t trial) { return FlightKey{condition, trial, "dqn"}; };
  std::string digest;
  {
    auto results = ResultStore::open_for_writing(folder / "out", remembering());
    CHECK(results.memory(dqn(0, 0)) == std::nullopt);
    CHECK(results.add(dqn(0, 0), flight, "a0") == Stored::added);
    CHECK(results.add(dqn(0, 1), flight, "a1") == Stored::added);
    CHECK(results.add(dqn(1, 0), flight, "b0") == Stored::added);
    CHECK(results.memory(dqn(0, 0)) == "a0");
    CHECK(results.add(dqn(0, 2), flight, "a2") == Stored::added);
    CHECK(results.memory(dqn(0, 0)) == std::nullopt);  // trial 2 is of the same lineage
    // A flight that comes again, late, changes nothing.
    CHECK(results.add(dqn(0, 0), flight, "a0") == Stored::already_there);
    digest = results.digest();
  }
  const auto results = ResultStore::open_for_reading(folder / "out");
  CHECK(results.memory(dqn(0, 2)) == "a2");
  CHECK(results.memory(dqn(0, 1)) == "a1");
  CHECK(results.memory(dqn(1, 0)) == "b0");
  CHECK(results.memory({0, 0, "min-height"}) == std::nullopt);
  CHECK(digest == sha256_hex("0 0 dqn " + sha256_hex(flight) + "\n0 1 dqn " + sha256_hex(flight) + "\n0 2 dqn " +
                             sha256_hex(flight) + "\n1 0 dqn " + sha256_hex(flight) + "\n"));
}

TEST_CASE("memory is all or nothing with its flight, and an altered one is refused") {
  const Folder folder;
  const std::string flight = flight_with(1.0);
  {
    auto results = ResultStore::open_for_writing(folder / "out", remembering());
    CHECK_THROWS_WITH(results.add({0, 0, "dqn"}, flight), Contains("memory for the next flight is missing"));
    CHECK_THROWS_WITH(results.add({0, 0, "min-height"}, flight, "x"), Contains("has no memory to keep"));
    CHECK_THROWS(results.batch([&] {
      (void)results.add({0, 0, "dqn"}, flight, "a0");
      throw std::runtime_error("killed");
    }));
    CHECK(results.keys().empty());
    CHECK(results.memory({0, 0, "dqn"}) == std::nullopt);
    CHECK(results.add({0, 0, "dqn"}, flight, "a0") == Stored::added);
  }
  SECTION("its bytes") {
    run_sql(folder / "out", "UPDATE memory SET bytes = x'6131'");
    CHECK_THROWS_WITH(ResultStore::open_for_reading(folder / "out").memory({0, 0, "dqn"}),
                      Contains("memory of agent 'dqn' after trial 0 was altered"));
  }
  SECTION("its flight") {
    run_sql(folder / "out", "UPDATE memory SET condition = 1");
    CHECK_THROWS_WITH(ResultStore::open_for_reading(folder / "out").memory({1, 0, "dqn"}),
                      Contains("memory of agent 'dqn' after trial 0 was altered"));
  }
}

TEST_CASE("a database of the previous format can be read, and gets the present one when it is written again") {
  const Folder folder;
  { (void)ResultStore::open_for_writing(folder / "out", remembering()).add({0, 0, "min-height"}, flight_with(1.0)); }
  {
    SQLite::Database database((folder / "out" / "results.sqlite").string(), SQLite::OPEN_READWRITE);
    database.exec("DROP TABLE memory; DROP TRIGGER count_flights; DROP TABLE tally; PRAGMA user_version = 2");
  }
  CHECK(ResultStore::open_for_reading(folder / "out").flights().size() == 1);
  {
    auto results = ResultStore::open_for_writing(folder / "out", remembering());
    CHECK(results.add({0, 0, "dqn"}, flight_with(1.0), "a0") == Stored::added);
    CHECK(results.memory({0, 0, "dqn"}) == "a0");
  }
  CHECK(ResultStore::open_for_reading(folder / "out").flights().size() == 2);
  run_sql(folder / "out", "DELETE FROM flight WHERE agent = 'min-height'");
  run_sql(folder / "out", "DELETE FROM trace WHERE flight = 0");
  CHECK_THROWS_WITH(ResultStore::open_for_reading(folder / "out"),
                    Contains("it holds 1 flights and 1 traces, and 2 were stored"));
}

TEST_CASE("the writer of a folder is noted there, and the writer of a copy only in the copy") {
  const Folder folder;
  const ProcessName writer{0xFFFFFFFFFFFFFFFF, "alpha", 5217, 1'795'355'110};
  {
    auto results = ResultStore::open_for_writing(folder / "out", small());
    CHECK_FALSE(results.writer());
    results.sign(writer);
    const auto reader = ResultStore::open_for_reading(folder / "out");
    REQUIRE(reader.writer());
    CHECK(reader.writer()->incarnation == writer.incarnation);
    CHECK(reader.writer()->host == "alpha");
    CHECK(reader.writer()->pid == 5217);
    CHECK(reader.writer()->since_s == writer.since_s);
  }
  std::filesystem::copy(folder / "out", folder / "copy");
  auto copy = ResultStore::open_for_writing(folder / "copy", small());
  copy.sign({7, "beta", 1, 1});
  CHECK(ResultStore::open_for_reading(folder / "out").writer()->incarnation == writer.incarnation);
}

TEST_CASE("a database of the format without a table of writers has no writer, and can be signed") {
  const Folder folder;
  { (void)ResultStore::open_for_writing(folder / "out", small()); }
  {
    SQLite::Database database((folder / "out" / "results.sqlite").string(), SQLite::OPEN_READWRITE);
    database.exec("DROP TABLE writer; DROP TRIGGER count_flights; DROP TABLE tally; PRAGMA user_version = 2");
  }
  CHECK_FALSE(ResultStore::open_for_reading(folder / "out").writer());
  auto results = ResultStore::open_for_writing(folder / "out", small());
  results.sign({7, "beta", 1, 1});
  CHECK(ResultStore::open_for_reading(folder / "out").writer()->incarnation == 7);
}

TEST_CASE("flights are looked up and counted while another process stores them, and gaps are named") {
  const Folder folder;
  auto results = ResultStore::open_for_writing(folder / "out", small());
  const auto reader = ResultStore::open_for_reading(folder / "out");
  CHECK_FALSE(reader.holds(first));
  CHECK(reader.count() == 0);
  CHECK(shortfall(reader).flights == 80);
  CHECK(shortfall(reader).first.size() == 10);
  results.add(first, flight_with(1.0));
  CHECK(reader.holds(first));
  CHECK_FALSE(reader.holds(second));
  CHECK_THROWS_AS(reader.holds({0, 0, "planner"}), std::logic_error);
  for (std::uint32_t condition = 0; condition < 2; ++condition)
    for (std::uint32_t trial = 0; trial < 20; ++trial)
      for (const char* agent : {"min-height", "constant-120"}) {
        const FlightKey key{condition, trial, agent};
        if (key != second && key != later && key != FlightKey{1, 19, "constant-120"})
          results.add(key, flight_with(1.0));
      }
  const Shortfall missing = shortfall(reader, 2);
  CHECK(missing.flights == 3);
  CHECK(missing.first == std::vector<FlightKey>{second, later});
  CHECK(missing.text(small()) ==
        "3 of 80 flights are missing: agent constant-120 in trial 0 of condition 0 (bs_density_per_km2=1), agent "
        "min-height in trial 7 of condition 1 (bs_density_per_km2=5) and 1 more");
  for (const FlightKey& key : {second, later, FlightKey{1, 19, "constant-120"}}) results.add(key, flight_with(1.0));
  CHECK(shortfall(reader).flights == 0);
  CHECK(reader.count() == 80);
}
