// A network that loses, duplicates, reorders and delays (bad_network.cpp): the same bytes as in one process.
#include <catch2/catch.hpp>
#include <filesystem>
#include <map>
#include <sstream>

#include "tests/faults/effort.hpp"
#include "tests/faults/fault_scene.hpp"
#include "tests/paths.hpp"

using namespace aloft::test;
using namespace std::chrono_literals;

namespace {

const std::string library = (bin_dir().parent_path() / "lib/libaloft_bad_network.so").string();

/// Number of times that each fault happened in all processes of a run, as they log it at their end.
std::map<std::string, int> faults_of(const FaultScene& scene, const std::string& run) {
  const std::string mark = "messages that were damaged:";
  std::map<std::string, int> total;
  for (const auto& entry : std::filesystem::directory_iterator(scene.out(run) / "log")) {
    std::istringstream lines(read_text(entry.path()));
    for (std::string line; std::getline(lines, line);) {
      const std::size_t at = line.find(mark);
      if (at == std::string::npos) continue;
      std::istringstream words(line.substr(at + mark.size()));
      for (std::string word; words >> word;)
        total[word.substr(0, word.find('='))] += std::stoi(word.substr(word.find('=') + 1));
    }
  }
  return total;
}

/// The faults that a network asks for: "data=5,delay_ms=20" asks for data.
std::vector<std::string> wanted(const std::string& network) {
  std::vector<std::string> names;
  std::istringstream parts(network);
  for (std::string part; std::getline(parts, part, ',');)
    if (const std::string name = part.substr(0, part.find('=')); name != "delay_ms") names.push_back(name);
  return names;
}

}  // namespace

TEST_CASE("a bad network costs time, but no byte", "[network]") {
  const FaultScene scene(effort(4, 16));
  // Fragments and gaps are rare, so half of them are lost.
  std::vector<std::string> networks{
      "data=30",      "data_frag=50",
      "heartbeat=30", "acknack=30",
      "gap=50",       "data=5,data_frag=50,heartbeat=5,acknack=5,gap=50",
      "any=10",       "duplicate=30",
      "delay=50",     "delay=5,delay_ms=2000,duplicate=5",
  };
  if (soak())
    networks.insert(networks.end(), {"data=10", "heartbeat=10", "acknack=10", "any=20", "any=5,duplicate=20,delay=20",
                                     "delay=100,delay_ms=100", "delay=20,delay_ms=2000"});
  for (const std::string& network : networks) {
    INFO(network);
    const Variable preload("LD_PRELOAD", library);
    const Variable faults("ALOFT_TEST_FAULTS", network);
    const auto run = scene.start(network, {"--workers", "2"});
    scene.check_finished(network, *run, 240s);
    std::map<std::string, int> happened = faults_of(scene, network);
    for (const std::string& fault : wanted(network)) {
      INFO(fault);
      CHECK(happened[fault] > 0);
    }
  }
}

TEST_CASE("the shipped programs ignore the variable for bad networks", "[network]") {
  const FaultScene scene(1);
  const Variable faults("ALOFT_TEST_FAULTS", "any=100");
  scene.check_finished("shipped", *scene.start("shipped", {"--workers", "1"}), 120s);
  CHECK(faults_of(scene, "shipped").empty());
}

TEST_CASE("invalid settings of a bad network are refused", "[network]") {
  const FaultScene scene(1);
  for (const char* wrong : {"data", "data=", "data=101", "data=-1", "delay_ms=1e3", "losses=5", "data=5;gap=5"}) {
    INFO(wrong);
    const Variable preload("LD_PRELOAD", library);
    const Variable faults("ALOFT_TEST_FAULTS", wrong);
    const Finished finished = run_command({"aloft-coordinator", "--results", scene.out("x").string(), "--experiment",
                                           (scene.out("reference") / "experiment.json").string()});
    CHECK(finished.exit_code == 2);
    CHECK_THAT(finished.err, Catch::Contains("ALOFT_TEST_FAULTS"));
  }
}
