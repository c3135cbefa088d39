#include <algorithm>
#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include "common/flight/flight.hpp"
#include "common/flight/testing/conformance.hpp"
#include "common/flight/testing/synthetic_map.hpp"

using namespace aloft::agents;
using aloft::flight::SyntheticMap;

namespace {

/// The best sum of quality from `level` after `step` steps, by trying every sequence of actions.
double best_sum(const SyntheticMap& map, std::uint32_t step, int level) {
  if (step == map.steps()) return 0.0;
  const auto& column = map.qos()[map.result_point(step + 1)];
  double best = -1.0;
  for (int to = std::max(level - 1, 0); to <= std::min(level + 1, static_cast<int>(column.size()) - 1); ++to)
    best = std::max(best, column[static_cast<std::size_t>(to)] + best_sum(map, step + 1, to));
  return best;
}

aloft::flight::FlightRecord plan(SyntheticMap& map) {
  const AgentSpec spec = parse_agents("planner", "agents[0]").front();
  return aloft::flight::fly(map, 1, 0, *spec.make(), spec);
}

}  // namespace

TEST_CASE("planner conforms") {
  aloft::flight::check_conformance("planner");
}

TEST_CASE("planner flies the best of all feasible flights") {
  for (const QosKind kind : {QosKind::spectral_efficiency, QosKind::throughput}) {
    for (std::uint64_t seed = 0; seed < 40; ++seed) {
      SyntheticMap map = SyntheticMap::random(kind, 7, 2 + static_cast<std::uint32_t>(seed % 4), seed);
      INFO("seed " << seed);
      CHECK(plan(map).qos_mean() * map.steps() == Approx(best_sum(map, 0, 0)).epsilon(1e-12));
    }
  }
}

TEST_CASE("planner uses only the heights of levels, also in a finer map") {
  const aloft::radio::HeightGrid grid{40, 60, 10, 5};
  SyntheticMap map(QosKind::spectral_efficiency, grid,
                   {{0, 0, 0, 0, 0}, {1, 9, 0, 9, 0}, {0, 9, 0, 9, 0}, {0, 0, 0, 0, 3}});
  // By hand: staying at 40 m gives 1; climbing to 60 m by the last step gives 3, via 50 m at step 1 or 2: hold first.
  const auto record = plan(map);
  CHECK(record.steps[0].height_m == 40.0);
  CHECK(record.steps[1].height_m == 50.0);
  CHECK(record.steps[2].height_m == 60.0);
  CHECK(record.qos_mean() * 3 == Approx(4.0));
}

TEST_CASE("planner holds where no action gains quality") {
  const aloft::radio::HeightGrid grid{40, 60, 10, 10};
  SyntheticMap map(QosKind::throughput, grid, std::vector<std::vector<double>>(6, {5.0, 5.0, 5.0}));
  CHECK(plan(map).height_changes() == 0);
}
