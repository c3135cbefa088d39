// A few short flights of every agent, as text, compared byte for byte: no result changes silently.
// tools/golden.sh writes them anew and shows the difference.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <catch2/catch.hpp>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <set>
#include <sstream>

#include "common/base/read_file.hpp"
#include "common/base/write_file.hpp"
#include "common/experiment/trial_world.hpp"
#include "common/flight/relay.hpp"
#include "common/learn/network.hpp"
#include "tests/paths.hpp"
#include "tests/skip.hpp"

using namespace aloft;
using Json = nlohmann::json;

namespace {

const std::filesystem::path folder = aloft::test::source_dir() / "tests/golden";

experiment::Experiment golden_experiment(const Json& worlds, const Json& agents) {
  const Json document{{"name", "golden"}, {"seed", 5}, {"trials", 2}, {"worlds", worlds}, {"agents", agents}};
  return experiment::parse(document.dump(), "golden");
}

const Json city{{"kind", "generated"}, {"bs_density_per_km2", 5}, {"building_density_per_km2", 200}, {"steps", 24}};

Json measured(const char* file) {
  return {{"kind", "measured"}, {"file", (folder / file).string()}};
}

bool knows_the_map(const agents::AgentType& type) {
  return type.privilege == agents::Privilege::site_map;
}

/// Agents with the site map. Their measured flight is that of the others, but has positions and base stations.
experiment::Experiment golden_maps() {
  Json wrong = city;
  wrong.update(
      {{"name", "wrong map"}, {"site_map_error_m", 25}, {"site_map_missing", 0.1}, {"site_map_route_points", 10}});
  Json agents = Json::array();
  for (const agents::AgentType& type : agents::agent_types())
    if (knows_the_map(type)) agents.push_back(type.name);
  return golden_experiment({city, wrong, measured("surveyed.csv")}, agents);
}

/// Every other agent that flies in this process, the DQN with the options of the published code, and a relay in which a
/// shadow takes over.
experiment::Experiment golden_reports() {
  Json agents = Json::array();
  for (const agents::AgentType& type : agents::agent_types())
    if (!type.foreign && !type.relay && !knows_the_map(type)) agents.push_back(type.name);
  agents.push_back({{"type", "dqn"},
                    {"name", "dqn-published"},
                    {"loss", "cross-entropy"},
                    {"target_network", false},
                    {"input_scaling", "linear-max"}});
  agents.push_back({{"type", "relay"},
                    {"name", "relay"},
                    {"crew", {{{"agent", "random-walk"}}, {{"agent", "dqn"}, {"from_step", 13}}}}});
  return golden_experiment({city, measured("flight.csv")}, agents);
}

std::string_view name_of(agents::Action action) {
  constexpr std::array<std::string_view, 5> names{"none", "down", "hold", "up", "absolute"};
  return names.at(static_cast<std::size_t>(action));
}

/// Numbers in the shortest form that reads back as the same bits.
void write_step(std::string& text, const flight::StepRecord& step) {
  text += fmt::format("{} {} {} {} {} {} {} {} {}", step.step, name_of(step.action), step.x_m, step.y_m, step.height_m,
                      step.serving_cell, step.serving_sinr_db, step.qos, step.reward);
  if (step.introspection)
    text += fmt::format(" | {} {} {}", step.introspection->epsilon, step.introspection->loss,
                        fmt::join(step.introspection->q_values, " "));
  text += '\n';
}

flight::FlightRecord fly(radio::SignalMap& map, const experiment::Experiment& experiment, std::uint32_t trial,
                         const agents::AgentSpec& spec) {
  if (!spec.crew.empty()) return flight::fly_relay(map, experiment.seed, trial, spec);
  return flight::fly(map, experiment.seed, trial, *spec.make(), spec);
}

std::string golden_text(const experiment::Experiment& experiment, const agents::AgentSpec& spec) {
  std::string text = "step action x_m y_m height_m serving_cell serving_sinr_db qos reward";
  text += " | epsilon loss q_down q_hold q_up\n";
  for (const experiment::Condition& condition : experiment.conditions) {
    for (std::uint32_t trial = 0; trial < experiment.trials; ++trial) {
      const auto map = experiment::make_signal_map(experiment, condition, trial);
      const flight::FlightRecord record = fly(*map, experiment, trial, spec);
      text += fmt::format("\n{}, trial {}\n",
                          condition.kind == experiment::WorldKind::measured ? "measured" : "generated", trial);
      for (const flight::StepRecord& step : record.steps) write_step(text, step);
    }
  }
  return text;
}

std::filesystem::path golden_file(const std::string& agent) {
  return folder / (agent + ".txt");
}

/// The first line that differs, which is shorter to read than two whole files.
std::string first_difference(const std::string& stored, const std::string& now) {
  std::istringstream stored_lines(stored);
  std::istringstream now_lines(now);
  std::string before;
  std::string after;
  for (int line = 1;; ++line) {
    const bool more_before = static_cast<bool>(std::getline(stored_lines, before));
    const bool more_after = static_cast<bool>(std::getline(now_lines, after));
    if (!more_before && !more_after) return "only line ends differ";
    if (more_before != more_after || before != after)
      return fmt::format("line {}\nstored: {}\nnow:    {}", line, more_before ? before : "(end)",
                         more_after ? after : "(end)");
  }
}

bool trains(const agents::AgentSpec& spec) {
  return spec.type == "dqn" || std::any_of(spec.crew.begin(), spec.crew.end(),
                                           [](const agents::CrewMember& member) { return trains(member.agent); });
}

/// Flies again all agents that train networks in flight, or all others.
void check_golden_flights(const experiment::Experiment& experiment, bool trained_in_flight) {
  for (const agents::AgentSpec& spec : experiment.agents) {
    if (trains(spec) != trained_in_flight) continue;
    const std::filesystem::path file = golden_file(spec.name);
    INFO(file.string() << ": if the change is meant, run tools/golden.sh and read the difference that it shows");
    if (!std::filesystem::exists(file)) {
      FAIL_CHECK("this agent has no golden flights yet");
      continue;
    }
    const std::string stored = read_file(file);
    const std::string now = golden_text(experiment, spec);
    if (stored != now) FAIL_CHECK(first_difference(stored, now));
  }
}

}  // namespace

TEST_CASE("every agent flies its golden flights again, byte for byte") {
  check_golden_flights(golden_reports(), false);
  check_golden_flights(golden_maps(), false);
}

TEST_CASE("agents that train networks fly their golden flights again, byte for byte", "[needs-avx2]") {
  if (learn::available_paths().back() == learn::Path::portable)
    return test::skip("this CPU has no AVX2 with FMA, and the portable code rounds differently");
  check_golden_flights(golden_reports(), true);
}

TEST_CASE("every golden file belongs to an agent") {
  std::set<std::filesystem::path> expected;
  for (const experiment::Experiment& experiment : {golden_reports(), golden_maps()})
    for (const agents::AgentSpec& spec : experiment.agents) expected.insert(golden_file(spec.name));
  for (const auto& entry : std::filesystem::directory_iterator(folder))
    if (entry.path().extension() == ".txt") {
      INFO(entry.path().string() << ": no such agent any more; delete it");
      CHECK(expected.contains(entry.path()));
    }
}

// Runs only when asked for by name.
TEST_CASE("write the golden flights anew", "[.regenerate]") {
  for (const experiment::Experiment& experiment : {golden_reports(), golden_maps()})
    for (const agents::AgentSpec& spec : experiment.agents)
      write_file(golden_file(spec.name), golden_text(experiment, spec));
}
