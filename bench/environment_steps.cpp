// Steps per second of environments that a learner trains in: a random policy, every flight over a world of its own,
// worlds included. One thread and two in turns; the best turn of each is from a time in which other programs disturbed
// least. Steps per CPU second of all threads together say what a core does, whatever else runs on it.

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <limits>
#include <nlohmann/json.hpp>
#include <thread>
#include <vector>

#include "bench/shortest_turn.hpp"
#include "common/base/random.hpp"
#include "common/experiment/trial_world.hpp"
#include "common/flight/flight.hpp"

using namespace aloft;

namespace {

constexpr std::uint32_t flights_in_turn = 200;
constexpr int turns = 25;

experiment::Experiment worlds_with(double bs_density_per_km2) {
  const nlohmann::json document{{"name", "environment-steps"},
                                {"seed", 1},
                                {"trials", flights_in_turn},
                                {"world", {{"kind", "generated"}, {"bs_density_per_km2", bs_density_per_km2}}},
                                {"agents", {"random-walk"}}};
  return experiment::parse(document.dump(), "environment-steps");
}

void fly(const experiment::Experiment& experiment, std::uint32_t trial) {
  constexpr std::array actions{agents::Action::down, agents::Action::hold, agents::Action::up};
  const auto map = experiment::make_signal_map(experiment, experiment.conditions.front(), trial);
  flight::Flight flight(*map, experiment.seed, trial);
  RandomStream policy(experiment.seed, trial, "policy");
  while (!flight.finished()) flight.step({actions.at(policy.uniform_index(actions.size()))}, "policy");
}

/// Seconds of the shortest turn of so many threads that share the flights.
struct Best {
  double wall_s = std::numeric_limits<double>::infinity();
  double cpu_s = std::numeric_limits<double>::infinity();  // of all threads together
};

void turn(const experiment::Experiment& experiment, std::size_t threads, Best& best) {
  std::atomic<std::uint32_t> next{0};
  std::vector<double> cpu_s(threads, 0.0);
  const auto start = std::chrono::steady_clock::now();
  {
    std::vector<std::jthread> running;
    for (double& mine_s : cpu_s)
      running.emplace_back([&] {
        const double start_s = bench::thread_seconds();
        for (std::uint32_t trial = next++; trial < flights_in_turn; trial = next++) fly(experiment, trial);
        mine_s = bench::thread_seconds() - start_s;
      });
  }
  const std::chrono::duration<double> wall = std::chrono::steady_clock::now() - start;
  best.wall_s = std::min(best.wall_s, wall.count());
  double sum_s = 0.0;
  for (const double mine_s : cpu_s) sum_s += mine_s;
  best.cpu_s = std::min(best.cpu_s, sum_s);
}

}  // namespace

int main() {
  fmt::print("             steps per CPU second       steps per second\n");
  fmt::print("bs per km2   1 thread   2 threads    1 thread   2 threads   ratio\n");
  for (const double bs_density_per_km2 : {1.0, 2.5, 5.0}) {
    const experiment::Experiment experiment = worlds_with(bs_density_per_km2);
    const double steps = flights_in_turn * experiment.conditions.front().world.number("steps");
    Best one;
    Best two;
    for (int i = 0; i < turns; ++i) {
      turn(experiment, 1, one);
      turn(experiment, 2, two);
    }
    fmt::print("{:10} {:10.0f} {:11.0f} {:11.0f} {:11.0f} {:7.2f}\n", bs_density_per_km2, steps / one.cpu_s,
               steps / two.cpu_s, steps / one.wall_s, steps / two.wall_s, one.wall_s / two.wall_s);
  }
  return 0;
}
