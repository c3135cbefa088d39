// A full disk and damaged results: nothing is lost, and no result is wrong.
#include <SQLiteCpp/SQLiteCpp.h>
#include <fmt/format.h>
#include <signal.h>
#include <sys/mount.h>
#include <unistd.h>

#include <catch2/catch.hpp>
#include <fstream>
#include <set>
#include <sstream>
#include <thread>

#include "common/base/random.hpp"
#include "tests/faults/effort.hpp"
#include "tests/faults/fault_scene.hpp"
#include "tests/own_mounts.hpp"

using namespace aloft;
using namespace aloft::test;
using namespace std::chrono_literals;
using Catch::Contains;
namespace fs = std::filesystem;

namespace {

/// A file system of 1 MB; needs own_mounts().
class SmallDisk {
 public:
  explicit SmallDisk(fs::path at) : at_(std::move(at)) {
    fs::create_directories(at_);
    REQUIRE(mount("tmpfs", at_.c_str(), "tmpfs", 0, "size=1m") == 0);
  }
  ~SmallDisk() { umount2(at_.c_str(), MNT_DETACH); }
  SmallDisk(const SmallDisk&) = delete;
  SmallDisk& operator=(const SmallDisk&) = delete;
  void grow() const { REQUIRE(mount("tmpfs", at_.c_str(), "tmpfs", MS_REMOUNT, "size=200m") == 0); }

 private:
  fs::path at_;
};

/// Checks that the run into "full" fills its disk, reports it and waits.
void check_pauses(const FaultScene& scene, Command& run) {
  CHECK(eventually(60s, [&] { return run.error_so_far().find("is full") != std::string::npos || !run.running(); }));
  INFO(run.error_so_far());
  CHECK(run.running());
  CHECK_THAT(run.error_so_far(), Contains("flights wait, nothing can be stored") && Contains("make room"));
  const int stored = scene.stored("full");
  CHECK(stored < scene.flights());
  std::this_thread::sleep_for(2s);
  CHECK(scene.stored("full") == stored);
}

/// One way to damage a file, as a function of its bytes.
std::string damaged(const std::string& bytes, RandomStream& random) {
  std::string result = bytes;
  if (random.uniform_index(4) == 0) {
    result.resize(random.uniform_index(static_cast<std::uint32_t>(bytes.size())));
    return result;
  }
  const std::uint32_t bit = random.uniform_index(static_cast<std::uint32_t>(bytes.size() * 8));
  result[bit / 8] = static_cast<char>(result[bit / 8] ^ (1 << (bit % 8)));
  return result;
}

void write_bytes(const fs::path& file, const std::string& bytes) {
  std::ofstream(file, std::ios::binary | std::ios::trunc) << bytes;
}

std::set<std::string> lines_of(const std::string& text) {
  std::set<std::string> lines;
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);) lines.insert(line);
  return lines;
}

/// Checks that a command is refused with a hint about what to do.
bool is_refusal(const Finished& finished) {
  const bool refused = finished.exit_code == 1 || finished.exit_code == 2;
  if (refused) CHECK_THAT(finished.err, Contains("results.sqlite") || Contains("folder"));
  return refused;
}

}  // namespace

TEST_CASE("a full disk pauses a run with a clear message; it goes on when there is space", "[storage][needs-mounts]") {
  if (!own_mounts()) return;
  const FaultScene scene(30);
  const std::vector<std::string> over_dds{"--workers", "2"};
  const std::vector<std::string> in_process{"--workers", "2", "--in-process"};
  for (const auto& options : {over_dds, in_process}) {
    const SmallDisk disk(scene.out("full"));
    auto run = scene.start("full", options);
    check_pauses(scene, *run);
    if (options == in_process) {  // Ctrl-C works meanwhile, and the same command waits again
      run->send(SIGINT);
      CHECK(run->wait(10s).exit_code == 130);
      run = scene.start("full", options);
      check_pauses(scene, *run);
    }
    disk.grow();
    scene.check_finished("full", *run, 120s);
  }
}

TEST_CASE("damaged results are refused with a hint, or give the right numbers", "[storage]") {
  const FaultScene scene(2);
  const fs::path dir = scene.out("reference");
  const fs::path file = dir / "results.sqlite";
  const std::string intact = read_text(file);
  REQUIRE(intact.size() > 10'000);
  const std::vector<std::vector<std::string>> commands{
      {"aloft", "digest", dir.string()},
      {"aloft", "export", dir.string(), "--flights", "--format", "csv"},
      {"aloft", "export", dir.string(), "--steps", "--format", "csv"}};
  std::vector<std::string> expected;
  for (const auto& command : commands) expected.push_back(run_command(command).out);
  RandomStream random(23, 0, "damage");
  int refused = 0;
  for (int i = 0; i < effort(30, 1000); ++i) {
    INFO("damage " << i);
    const std::string bytes = damaged(intact, random);
    for (std::size_t c = 0; c < commands.size(); ++c) {
      write_bytes(file, bytes);
      const Finished finished = run_command(commands[c]);
      if (is_refusal(finished)) {
        ++refused;
        continue;
      }
      INFO(finished.err);
      CHECK(finished.exit_code == 0);
      CHECK(finished.out == expected[c]);
    }
    if (i % 10 != 0) continue;
    write_bytes(file, bytes);
    const Finished finished = run_command(scene.run_arguments("reference", {"--in-process"}), 120s);
    if (!is_refusal(finished)) CHECK(scene.digest("reference") == scene.reference());
  }
  CHECK(refused > 10);
}

TEST_CASE("rows that were removed are noticed by digest, compare and run", "[storage]") {
  const FaultScene scene(2);
  for (const char* removal :
       {"DELETE FROM trace WHERE flight = 3", "DELETE FROM experiment", "DELETE FROM flight WHERE id = 3",
        "DELETE FROM flight WHERE id >= 3; DELETE FROM trace WHERE flight >= 3"}) {
    INFO(removal);
    const std::string dir = scene.out("removed").string();
    fs::copy(scene.out("reference"), dir);
    SQLite::Database(dir + "/results.sqlite", SQLite::OPEN_READWRITE).exec(removal);
    for (const auto& command :
         std::vector<std::vector<std::string>>{{"aloft", "digest", dir},
                                               {"aloft", "compare", scene.out("reference").string(), dir},
                                               {"aloft", "export", dir, "--flights", "--format", "csv"},
                                               scene.run_arguments("removed", {}),
                                               scene.run_arguments("removed", {"--in-process"})}) {
      const Finished finished = run_command(command);
      CHECK(finished.exit_code == 1);
      CHECK_THAT(finished.err, Contains("results.sqlite' is damaged") && Contains("Restore the folder"));
      CHECK(finished.out.empty());
    }
    fs::remove_all(dir);
  }
}

TEST_CASE("a damaged write-ahead log loses at most flights, which the same command flies again", "[storage]") {
  const FaultScene scene(40);
  const std::vector<std::string> all_flights{"aloft",     "export",   scene.out("reference").string(),
                                             "--flights", "--format", "csv"};
  const std::set<std::string> right = lines_of(run_command(all_flights).out);
  auto run = scene.start("killed", {"--workers", "2"});
  scene.wait_for_flights("killed", *run, scene.flights() / 8);
  const std::vector<int> services = scene.services("killed", *run);
  run->send(SIGKILL);
  for (const int pid : services) kill(pid, SIGKILL);
  (void)run->wait();
  CHECK(eventually(10s, [&] { return processes_with(scene.out("killed").string()).empty(); }));

  const fs::path wal = scene.out("killed") / "results.sqlite-wal";
  const std::string intact = read_text(wal);
  REQUIRE(intact.size() > 4096);
  RandomStream random(29, 0, "damage");
  int went_on = 0;
  for (int i = 0; i < effort(8, 200); ++i) {
    INFO("damage " << i);
    const std::string name = fmt::format("damaged-{}", i);
    fs::copy(scene.out("killed"), scene.out(name), fs::copy_options::recursive);
    write_bytes(scene.out(name) / "results.sqlite-wal", damaged(intact, random));
    const Finished exported =
        run_command({"aloft", "export", scene.out(name).string(), "--flights", "--format", "csv"});
    if (is_refusal(exported)) continue;
    CHECK(exported.exit_code == 0);
    for (const std::string& line : lines_of(exported.out)) CHECK(right.contains(line));
    const Finished resumed = run_command(scene.run_arguments(name, {"--in-process"}), 120s);
    INFO(resumed.err);
    if (!is_refusal(resumed)) {
      CHECK(scene.digest(name) == scene.reference());
      ++went_on;
    }
    fs::remove_all(scene.out(name));
  }
  CHECK(went_on > 0);
}
