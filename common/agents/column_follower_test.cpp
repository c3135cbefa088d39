#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include "common/agents/smoothed_levels.hpp"
#include "common/flight/flight.hpp"
#include "common/flight/testing/conformance.hpp"
#include "common/flight/testing/synthetic_map.hpp"

using namespace aloft::agents;
using aloft::flight::SyntheticMap;
using nlohmann::json;

namespace {

using Table = std::vector<std::vector<double>>;

const aloft::radio::HeightGrid four_levels{40, 70, 10, 10};

std::vector<double> heights_flown(const json& entry, const Table& table) {
  SyntheticMap map(QosKind::spectral_efficiency, four_levels, table);
  const AgentSpec spec = parse_agents(entry, "agents[0]").front();
  std::vector<double> heights_m;
  for (const auto& step : aloft::flight::fly(map, 1, 0, *spec.make(), spec).steps) heights_m.push_back(step.height_m);
  return heights_m;
}

}  // namespace

TEST_CASE("column followers conform") {
  aloft::flight::check_conformance("present-column");
  aloft::flight::check_conformance({{"type", "next-column"}, {"horizon", {1, 3, 1000}}});
}

TEST_CASE("column followers fly as if the column stayed: the next one, or the present one") {
  const Table table{
      {0, 0, 0, 9},  // point 0 is never scored
      {5, 1, 1, 9},  // worth the way up over two bad levels if there are ten steps: 1, 1, 9, 9...
      {5, 1, 1, 9}, {9, 5, 5, 5}, {9, 5, 5, 5}, {9, 5, 5, 5}, {9, 5, 5, 5},
  };
  // Next: 50 and 60 m on the way to 70 m; then down again for the last four places.
  CHECK(heights_flown("next-column", table) == std::vector<double>{50, 60, 50, 40, 40, 40});
  // Present: the same one step later, because nothing was known before the first step.
  CHECK(heights_flown("present-column", table) == std::vector<double>{40, 50, 60, 50, 40, 40});
  // One step ahead the bad level is not worth passing, and without foresight of the later gain nobody leaves 40 m.
  CHECK(heights_flown({{"type", "next-column"}, {"horizon", 1}}, table) == std::vector<double>(6, 40.0));
}

TEST_CASE("the way up is flown only if there are steps enough to gain from it") {
  // At 40 m every step gives 5; on the way up 1 and 1, then 9 each: better from the fourth step at the top on.
  const auto first_of = [](std::size_t steps) {
    return heights_flown({{"type", "next-column"}, {"horizon", 100}}, Table(steps + 1, {5, 1, 1, 9})).front();
  };
  CHECK(first_of(4) == 40.0);  // 1 + 1 + 9 + 9 = 20 = 4 x 5: a tie, it holds
  CHECK(first_of(5) == 50.0);
}

TEST_CASE("levels are smoothed over the heights within reach, and cut at the ends") {
  HeightProfile profile{1, 40, 5, {1, 2, 4, 8, 16}};  // 40, 45, 50, 55, 60 m
  const FlightInfo flight{QosKind::spectral_efficiency, 40, 60, 10, 1};
  CHECK(smoothed_levels(profile, flight, 0) == std::vector<double>{1, 4, 16});
  CHECK(smoothed_levels(profile, flight, 4.9) == std::vector<double>{1, 4, 16});
  CHECK(smoothed_levels(profile, flight, 5) == std::vector<double>{1.5, 14.0 / 3, 12});
  CHECK(smoothed_levels(profile, flight, 1000) == std::vector<double>(3, 6.2));
}
