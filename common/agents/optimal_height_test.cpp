#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include "common/flight/flight.hpp"
#include "common/flight/testing/conformance.hpp"
#include "common/flight/testing/synthetic_map.hpp"

using namespace aloft::agents;
using aloft::flight::SyntheticMap;

TEST_CASE("optimal-height conforms") {
  aloft::flight::check_conformance("optimal-height");
}

TEST_CASE("optimal-height reads the largest quality of every column") {
  const aloft::radio::HeightGrid grid{40, 60, 10, 5};
  SyntheticMap map(QosKind::spectral_efficiency, grid,
                   {{9, 0, 0, 0, 0}, {5, 0, 1, 0, 9}, {0, 9, 5, 0, 5}, {7, 0, 0, 0, 7}, {0, 0, 0, 3, 0}});
  const AgentSpec spec = parse_agents("optimal-height", "agents[0]").front();
  const auto record = aloft::flight::fly(map, 1, 0, *spec.make(), spec);
  const std::vector<double> heights_m{60, 45, 40, 55};
  const std::vector<double> qos{9, 9, 7, 3};
  REQUIRE(record.steps.size() == 4);
  for (std::size_t i = 0; i < 4; ++i) {
    CHECK(record.steps[i].height_m == heights_m[i]);
    CHECK(record.steps[i].qos == qos[i]);
    CHECK(record.steps[i].action == Action::absolute);
  }
}
