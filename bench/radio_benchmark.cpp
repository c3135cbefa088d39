// The cost of worlds and radio: cities, blocking heights, SE tables, and how they grow.

#include <benchmark/benchmark.h>

#include <array>
#include <ctime>
#include <nlohmann/json.hpp>

#include "common/radio/expected_field.hpp"
#include "common/radio/generated_map.hpp"
#include "common/radio/generated_world.hpp"
#include "common/radio/line_of_sight.hpp"
#include "common/world/city.hpp"
#include "common/world/route.hpp"

namespace {

using namespace aloft;
using nlohmann::json;

constexpr std::uint64_t seed = 1;
constexpr std::uint32_t trials = 10;  // cities differ in their cost: each benchmark cycles through this many

Parameters world_with(double bs_density_per_km2, double building_density_per_km2, double window_m) {
  return radio::resolve_generated_world({{"bs_density_per_km2", bs_density_per_km2},
                                         {"building_density_per_km2", building_density_per_km2},
                                         {"window_m", window_m}},
                                        "world");
}

/// One SE table: 101 points x 201 heights.
void table(benchmark::State& state, const Parameters& world) {
  std::vector<world::City> cities;
  for (std::uint32_t trial = 0; trial < trials; ++trial) cities.push_back(world::generate_city(world, seed, trial));
  std::uint32_t trial = 0;
  double stations = 0.0;
  for ([[maybe_unused]] auto _ : state) {
    const auto map = radio::make_generated_map(world, cities[trial], seed, trial);
    map->prepare();
    benchmark::DoNotOptimize(map.get());
    stations += static_cast<double>(cities[trial].base_stations.size());
    trial = (trial + 1) % trials;
  }
  state.counters["stations"] = benchmark::Counter(stations, benchmark::Counter::kAvgIterations);
}

void se_table(benchmark::State& state) {
  table(state, world_with(static_cast<double>(state.range(0)) / 10.0, 200.0, 3000.0));
}
BENCHMARK(se_table)->ArgName("bs_per_10_km2")->Arg(10)->Arg(25)->Arg(50)->Unit(benchmark::kMillisecond);

/// SE tables over the channels of TR 36.777 (1: urban macro, 2: urban micro, 3: rural macro) beside that of the paper's
/// model, with the same base stations: `ratio` is of the CPU times of both, taken in turns.
void se_table_by_model(benchmark::State& state) {
  const std::array<const char*, 3> models{"uma-av", "umi-av", "rma-av"};
  const auto world_over = [](const char* model) {
    return radio::resolve_generated_world({{"propagation", model}, {"bs_density_per_km2", 5}}, "world");
  };
  const Parameters paper = world_over("power-law");
  const Parameters aerial = world_over(models.at(static_cast<std::size_t>(state.range(0)) - 1));
  double paper_ticks = 0.0;  // of CPU time
  double aerial_ticks = 0.0;
  std::uint32_t trial = 0;
  const auto make = [&trial](const Parameters& world, const world::City& city, double& ticks) {
    const std::clock_t begin = std::clock();
    const auto map = radio::make_generated_map(world, city, seed, trial);
    map->prepare();
    benchmark::DoNotOptimize(map.get());
    ticks += static_cast<double>(std::clock() - begin);
  };
  for ([[maybe_unused]] auto _ : state) {
    world::City city = world::generate_city(paper, seed, trial);
    make(paper, city, paper_ticks);
    city.base_station_height_m = aerial.number("base_station_height_m");
    make(aerial, city, aerial_ticks);
    trial = (trial + 1) % trials;
  }
  state.counters["ratio"] = aerial_ticks / paper_ticks;
}
BENCHMARK(se_table_by_model)->ArgName("model")->DenseRange(1, 3)->Unit(benchmark::kMillisecond)->MinTime(3.0);

/// The expected field of an exact site map, to compare with the SE table of the same city: 101 points x 21 heights. 1:
/// among buildings that are drawn, too.
void expected_field(benchmark::State& state) {
  const Parameters world = world_with(static_cast<double>(state.range(0)) / 10.0, 200.0, 3000.0);
  std::vector<radio::Survey> surveys;
  for (std::uint32_t trial = 0; trial < trials; ++trial)
    surveys.push_back(
        *radio::make_generated_map(world, world::generate_city(world, seed, trial), seed, trial)->survey());
  const world::Route route(world, world::generate_city(world, seed, 0));
  std::uint32_t trial = 0;
  std::vector<double> column(1 + static_cast<std::size_t>(200 / 10));
  for ([[maybe_unused]] auto _ : state) {
    const std::vector<world::Site>& sites = surveys[trial].map.sites;
    radio::ExpectedField field =
        state.range(1) == 0 ? radio::ExpectedField(world, sites) : radio::ExpectedField(world, sites, seed + 1, trial);
    for (std::uint32_t point = 0; point <= route.steps(); ++point)
      field.column(route.advance(point, route.start(), -1), column.data());
    benchmark::DoNotOptimize(column.data());
    trial = (trial + 1) % trials;
  }
}
BENCHMARK(expected_field)
    ->ArgNames({"bs_per_10_km2", "buildings"})
    ->ArgsProduct({{10, 25, 50}, {0, 1}})
    ->Unit(benchmark::kMillisecond);

void se_table_by_bs_density(benchmark::State& state) {
  table(state, world_with(static_cast<double>(state.range(0)), 200.0, 3000.0));
}
BENCHMARK(se_table_by_bs_density)
    ->ArgName("bs_per_km2")
    ->Arg(1)
    ->Arg(3)
    ->Arg(10)
    ->Arg(30)
    ->Arg(100)
    ->Arg(300)
    ->Unit(benchmark::kMillisecond);

void se_table_by_building_density(benchmark::State& state) {
  table(state, world_with(5.0, static_cast<double>(state.range(0)), 3000.0));
}
BENCHMARK(se_table_by_building_density)
    ->ArgName("buildings_per_km2")
    ->Arg(100)
    ->Arg(300)
    ->Arg(1000)
    ->Unit(benchmark::kMillisecond);

void se_table_by_window(benchmark::State& state) {
  table(state, world_with(5.0, 200.0, static_cast<double>(state.range(0))));
}
BENCHMARK(se_table_by_window)->ArgName("window_m")->Arg(3000)->Arg(6000)->Arg(10'000)->Unit(benchmark::kMillisecond);

/// The largest world there is.
void se_table_largest(benchmark::State& state) {
  table(state, world_with(300.0, 200.0, 10'000.0));
}
BENCHMARK(se_table_largest)->Unit(benchmark::kMillisecond)->Iterations(1);

/// A city and the blocking heights of all its base stations at all route points.
void city_and_blocking_heights(benchmark::State& state) {
  const Parameters world = world_with(5.0, static_cast<double>(state.range(0)), 3000.0);
  std::uint32_t trial = 0;
  for ([[maybe_unused]] auto _ : state) {
    const world::City city = world::generate_city(world, seed, trial++ % trials);
    const radio::Skyline skyline(city);
    const world::Route route(world, city);
    double sum_m = 0.0;
    for (std::uint32_t point = 0; point <= route.steps(); ++point) {
      const world::Position position = route.advance(point, route.start(), -1);
      for (const world::Position& station : city.base_stations)
        sum_m += skyline.blocking_height_m(radio::LosRay::published, position, station);
    }
    benchmark::DoNotOptimize(sum_m);
  }
}
BENCHMARK(city_and_blocking_heights)->ArgName("buildings_per_km2")->Arg(200)->Arg(1000)->Unit(benchmark::kMillisecond);

}  // namespace
