// Steps per second of environments that a learner trains in: a random policy, every flight over a world of its own,
// worlds included. One thread and two in turns; the best turn of each is from a time in which other programs disturbed
// least. Seconds are CPU time of the threads, so that it does not count how many cores other programs left.

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <limits>
#include <nlohmann/json.hpp>
#include <numeric>
#include <thread>
#include <vector>

#include "bench/shortest_turn.hpp"
#include "common/base/random.hpp"
#include "common/experiment/trial_world.hpp"
#include "common/flight/flight.hpp"

using namespace aloft;

namespace {

constexpr std::uint32_t flights_in_turn = 40;  // ten milliseconds: some turn is undisturbed
constexpr int turns = 300;

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

/// CPU seconds of so many threads that share the flights, together.
double turn_s(const experiment::Experiment& experiment, std::size_t threads) {
  std::atomic<std::uint32_t> next{0};
  std::vector<double> cpu_s(threads, 0.0);
  {
    std::vector<std::jthread> running;
    for (double& mine_s : cpu_s)
      running.emplace_back([&] {
        const double start_s = bench::thread_seconds();
        for (std::uint32_t trial = next++; trial < flights_in_turn; trial = next++) fly(experiment, trial);
        mine_s = bench::thread_seconds() - start_s;
      });
  }
  return std::accumulate(cpu_s.begin(), cpu_s.end(), 0.0);
}

}  // namespace

int main() {
  fmt::print("bs per km2   steps/s, 1 thread   steps/s, 2 threads   ratio\n");
  for (const double bs_density_per_km2 : {1.0, 2.5, 5.0}) {
    const experiment::Experiment experiment = worlds_with(bs_density_per_km2);
    const double steps = flights_in_turn * experiment.conditions.front().world.number("steps");
    double one_s = std::numeric_limits<double>::infinity();
    double two_s = one_s;
    for (int i = 0; i < turns; ++i) {
      one_s = std::min(one_s, turn_s(experiment, 1));
      two_s = std::min(two_s, turn_s(experiment, 2));
    }
    fmt::print("{:10} {:19.0f} {:20.0f} {:7.2f}\n", bs_density_per_km2, steps / one_s, 2.0 * steps / two_s,
               2.0 * one_s / two_s);
  }
  return 0;
}
