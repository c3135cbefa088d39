#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include "common/base/read_file.hpp"
#include "common/flight/flight.hpp"
#include "common/radio/measured_map.hpp"
#include "common/world/measured_flight.hpp"
#include "tests/published_data.hpp"

using namespace aloft;

namespace {

double mean_mbps(radio::SignalMap& map, const nlohmann::json& agent, std::uint32_t trial = 0) {
  const agents::AgentSpec spec = agents::parse_agents(agent, "agents[0]").front();
  return flight::fly(map, 1, trial, *spec.make(), spec).qos_mean() / 1'000.0;
}

}  // namespace

TEST_CASE("agents on the real flight over Grand Canal Quay", "[needs-gcq]") {
  const auto gcq_csv = aloft::test::published_file("gcq.csv");
  if (gcq_csv.empty()) return;
  const auto map = radio::make_measured_map(world::parse_measured_flight(aloft::read_file(gcq_csv), "gcq.csv"));
  // Computed elsewhere, in Mbit/s.
  CHECK(mean_mbps(*map, "min-height") == Approx(68.18).margin(0.01));
  CHECK(mean_mbps(*map, "constant-60") == Approx(41.49).margin(0.01));
  CHECK(mean_mbps(*map, "constant-120") == Approx(40.99).margin(0.01));
  CHECK(mean_mbps(*map, "optimal-height") == Approx(82.12).margin(0.01));
  CHECK(mean_mbps(*map, "planner") == Approx(81.23).margin(0.01));
  CHECK(mean_mbps(*map, "one-step-ahead") == Approx(80.08).margin(0.01));
  CHECK(mean_mbps(*map, "height-filter") == Approx(76.64).margin(0.01));
  CHECK(mean_mbps(*map, "local-bandit") >= 74.0);
  CHECK(mean_mbps(*map, "pretrained") >= 74.5);

  double random_walks = 0.0;
  for (std::uint32_t trial = 0; trial < 100; ++trial) random_walks += mean_mbps(*map, "random-walk", trial) / 100.0;
  CHECK(random_walks >= 47.0);
  CHECK(random_walks <= 54.0);
}
