#include "common/flight/flight.hpp"

#include <array>
#include <catch2/catch.hpp>
#include <limits>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "common/base/error.hpp"
#include "common/flight/testing/synthetic_map.hpp"

using namespace aloft;
using agents::Action;
using flight::Flight;
using flight::SyntheticMap;
using radio::QosKind;

namespace {

const radio::HeightGrid three_levels{40.0, 60.0, 10.0, 10.0};

/// Quality = 100 * point + level: every reading tells where it was taken.
SyntheticMap labelled(QosKind kind, std::uint32_t points, const radio::HeightGrid& grid = three_levels) {
  std::vector<std::vector<double>> qos(points);
  for (std::uint32_t point = 0; point < points; ++point)
    for (std::uint32_t i = 0; i < grid.size(); ++i) qos[point].push_back(100.0 * point + i);
  return {kind, grid, std::move(qos)};
}

agents::AgentSpec spec_of(const char* entry) {
  return agents::parse_agents(entry, "agents[0]").front();
}

}  // namespace

TEST_CASE("a generated flight scores step j at route point j, after the j-th action") {
  SyntheticMap map = labelled(QosKind::spectral_efficiency, 5);
  Flight flight(map, 7, 3);
  CHECK(flight.info().steps == 4);
  CHECK(flight.info().seed == 7);
  CHECK(flight.info().trial == 3);
  CHECK(flight.observation().step == 0);
  CHECK(flight.observation().qos == 0.0);
  CHECK(flight.observation().height_m == 40.0);
  CHECK(flight.observation().executed == Action::none);
  CHECK(flight.observation().reward == 0.0);

  const Action commands[] = {Action::up, Action::up, Action::up, Action::down};
  const double qos[] = {101.0, 202.0, 302.0, 401.0};
  const double height_m[] = {50.0, 60.0, 60.0, 50.0};
  const Action executed[] = {Action::up, Action::up, Action::hold, Action::down};  // the third hits the ceiling
  for (std::size_t i = 0; i < 4; ++i) {
    CHECK_FALSE(flight.finished());
    flight.step({commands[i]}, "me");
    CHECK(flight.observation().step == i + 1);
    CHECK(flight.observation().qos == qos[i]);
    CHECK(flight.observation().reward == qos[i]);
    CHECK(flight.observation().height_m == height_m[i]);
    CHECK(flight.observation().executed == executed[i]);
    CHECK(flight.record().steps.back().x_m == 10.0 * static_cast<double>(i + 1));
  }
  CHECK(flight.finished());
  CHECK_THROWS_AS(flight.step({Action::hold}, "me"), std::logic_error);

  // By hand: (101 + 202 + 302 + 401) / 4, (50 + 60 + 60 + 50) / 4, and changes at steps 1, 2 and 4.
  CHECK(flight.record().qos_mean() == 251.5);
  CHECK(flight.record().height_mean_m() == 55.0);
  CHECK(flight.record().height_changes() == 3);
}

TEST_CASE("energy and handovers are subtracted from the reward, not from the quality") {
  SyntheticMap map = labelled(QosKind::spectral_efficiency, 5);
  Flight flight(map, 7, 3, {.speed_m_per_s = 20.0, .energy_weight = 0.25, .handover_cost = 3.0});
  // Quality modulo 7 is the cell: 3, 5, 6, 1, so every step but the first is a handover.
  const Action commands[] = {Action::up, Action::hold, Action::down, Action::hold};
  const double qos[] = {101.0, 201.0, 300.0, 400.0};
  const double climb_j[] = {20.0 * 10.0 / 0.7, 0.0, 0.0, 0.0};
  const double handover[] = {0.0, 1.0, 1.0, 1.0};
  const double level_j = 178.29582 / 2.0;  // half a second at 20 m/s
  for (std::size_t i = 0; i < 4; ++i) {
    flight.step({commands[i]}, "me");
    CHECK(flight.observation().qos == qos[i]);
    CHECK(flight.observation().reward ==
          Approx(qos[i] - 0.25 * (level_j + climb_j[i]) - 3.0 * handover[i]).epsilon(1e-7));
    CHECK(flight.record().steps.back().reward == flight.observation().reward);
  }
  CHECK(flight.record().handovers() == 3U);
}

TEST_CASE("a step with a handover loses a share of its quality in the reward, not in the record") {
  SyntheticMap map = labelled(QosKind::spectral_efficiency, 5);
  Flight flight(map, 7, 3, {.handover_cost = 3.0, .handover_loss = 0.5});
  const double qos[] = {101.0, 201.0, 301.0, 401.0};  // cells 3, 5, 0 and 2: every step but the first is a handover
  const double reward[] = {101.0, 97.5, 147.5, 197.5};
  for (std::size_t i = 0; i < 4; ++i) {
    flight.step({i == 0 ? Action::up : Action::hold}, "me");
    CHECK(flight.observation().qos == qos[i]);
    CHECK(flight.observation().reward == reward[i]);
    CHECK(flight.handovers() == (i == 0 ? 0 : 1));
  }
}

TEST_CASE("where networks hand the UAV over, the serving cell is that of its past") {
  // Exact measurements without filter; handovers are triggered, prepared and executed in 0.3, 0.1 and 0.1 s.
  const radio::A3Rules rules{.time_to_trigger_s = 0.3,
                             .l3_filter_k = 0,
                             .measurement_error_db = 0.0,
                             .preparation_s = 0.1,
                             .execution_s = 0.1};
  // Cells 0, 4, 5 and 6 are the strongest at points 0 to 3; each other one is 3 dB weaker than the one before it.
  SyntheticMap map(QosKind::spectral_efficiency, three_levels,
                   {{7.0, 7.0, 7.0}, {18.0, 18.0, 18.0}, {18.0, 18.0, 18.0}, {18.0, 18.0, 18.0}});
  Flight flight(map, 7, 3, {.handover_cost = 2.0, .handover_loss = 0.5, .a3 = rules});
  CHECK(flight.observation().serving_cell == 0);
  CHECK(flight.observation().qos == 7.0);
  // To point 1 cell 0 falls from -80 to -89 dBm and cell 4 grows from -92 to -80 dBm: -84.8 and -85.4 dBm at 0.6 s and
  // -86.6 and -83 dBm at 0.8 s, more than 2 dB apart: triggered at 1.1 s, commanded at 1.2 s, executed at 1.3 s. Cell 0
  // is the fourth there, with a quarter of the quality.
  flight.step({Action::hold}, "me");
  CHECK(flight.observation().serving_cell == 0);
  CHECK(flight.observation().qos == 4.5);
  CHECK(flight.observation().reward == 4.5);
  const double best_db = flight.observation().neighbour_sinr_db[0];
  CHECK(flight.observation().serving_sinr_db == best_db - 9.0);
  CHECK(flight.observation().neighbour_count == 5);
  for (std::size_t i = 0; i < 5; ++i)  // descending, without the serving cell's -9 dB
    CHECK(flight.observation().neighbour_sinr_db.at(i) == best_db - std::array{0.0, 3.0, 6.0, 12.0, 15.0}.at(i));
  flight.step({Action::hold}, "me");
  CHECK(flight.observation().serving_cell == 4);
  CHECK(flight.observation().serving_sinr_db == best_db);
  CHECK(flight.observation().qos == Approx(0.2 * 4.5 + 0.7 * 18.0).epsilon(1e-12));
  CHECK(flight.observation().reward == Approx(0.5 * (0.2 * 4.5 + 0.7 * 18.0) - 2.0).epsilon(1e-12));
  CHECK(flight.handovers() == 1);
  CHECK(flight.record().steps.back().mobility == flight::MobilityEvents{1, 0, 0, 0.1});
  flight.step({Action::hold}, "me");
  CHECK(flight.observation().qos == 18.0);
  CHECK(flight.handovers() == 0);
  CHECK(flight.record().mobility() == flight::MobilityEvents{1, 0, 0, 0.1});
}

TEST_CASE("a measured flight scores step j at the j-th column") {
  SyntheticMap map = labelled(QosKind::throughput, 3);
  Flight flight(map, 1, 0);
  CHECK(flight.info().steps == 3);
  CHECK(flight.observation().qos == 0.0);
  flight.step({Action::up}, "me");
  CHECK(flight.observation().qos == 1.0);
  flight.step({Action::down}, "me");
  CHECK(flight.observation().qos == 100.0);
  flight.step({Action::down}, "me");
  CHECK(flight.observation().qos == 200.0);
  CHECK(flight.observation().executed == Action::hold);  // the floor
  CHECK(flight.finished());
  CHECK(flight.record().height_changes() == 2);
}

TEST_CASE("an absolute height is rounded to the grid and clamped") {
  const radio::HeightGrid metres{40.0, 60.0, 10.0, 1.0};
  SyntheticMap map = labelled(QosKind::spectral_efficiency, 8, metres);
  Flight flight(map, 1, 0);
  const double given_m[] = {47.4, 47.6, 1e300, -1e300, std::numeric_limits<double>::infinity()};
  const double flown_m[] = {47.0, 48.0, 60.0, 40.0, 60.0};
  for (std::size_t i = 0; i < 5; ++i) {
    flight.step({Action::absolute, given_m[i]}, "me");
    CHECK(flight.observation().height_m == flown_m[i]);
    CHECK(flight.observation().executed == Action::absolute);
  }
  CHECK_THROWS_AS(flight.step({Action::absolute, std::numeric_limits<double>::quiet_NaN()}, "me"), std::logic_error);
  CHECK_THROWS_AS(flight.step({Action::none}, "me"), std::logic_error);
  flight.step({Action::absolute, 53.0}, "me");
  flight.step({Action::up}, "me");  // by d, cut at the ceiling
  CHECK(flight.observation().height_m == 60.0);
  CHECK(flight.observation().executed == Action::up);
}

TEST_CASE("a profile shows every height where the result of a step will be read") {
  SyntheticMap map = labelled(QosKind::spectral_efficiency, 4);
  Flight flight(map, 1, 0);
  const agents::HeightProfile third = flight.profile(3);
  CHECK(third.step == 3);
  CHECK(third.height_min_m == 40.0);
  CHECK(third.resolution_m == 10.0);
  CHECK(third.qos == std::vector<double>{300.0, 301.0, 302.0});
  CHECK_THROWS_AS(flight.profile(0), std::logic_error);
  CHECK_THROWS_AS(flight.profile(4), std::logic_error);

  SyntheticMap measured = labelled(QosKind::throughput, 4);
  CHECK(Flight(measured, 1, 0).profile(3).qos == std::vector<double>{200.0, 201.0, 202.0});
}

TEST_CASE("with a route that follows the serving cell, the UAV swerves as its reports say") {
  SyntheticMap map = labelled(QosKind::spectral_efficiency, 4);
  map.follow_serving_cell();
  Flight flight(map, 1, 0);
  // The serving cell is qos % 7, 0 at the start: the UAV swerves as for even cells, and reads the next column there.
  CHECK(flight.profile(1).qos == std::vector<double>{200.0, 201.0, 202.0});
  CHECK_THROWS_AS(flight.profile(2), std::logic_error);
  flight.step({Action::up}, "me");
  CHECK(flight.record().steps.back().y_m == -10.0);
  CHECK(flight.observation().qos == 201.0);
  // Cell 201 % 7 = 5 is odd: back to the straight line.
  CHECK(flight.profile(2).qos == std::vector<double>{200.0, 201.0, 202.0});
  flight.step({Action::hold}, "me");
  CHECK(flight.record().steps.back().y_m == 0.0);
  CHECK(flight.observation().qos == 201.0);

  agents::HeightProfile buffer;
  const Flight fresh(map, 1, 0);
  CHECK_THROWS_AS(flight::foresee(fresh, agents::Privilege::whole_route, buffer, [](const auto&) {}), InputError);
}

TEST_CASE("privileged agents foresee the next step, or all before the first command") {
  SyntheticMap map = labelled(QosKind::spectral_efficiency, 4);
  Flight flight(map, 1, 0);
  agents::HeightProfile buffer;
  const auto seen = [&](agents::Privilege privilege) {
    std::vector<std::uint32_t> steps;
    flight::foresee(flight, privilege, buffer, [&](const agents::HeightProfile& profile) {
      steps.push_back(profile.step);
      CHECK(profile.qos[0] == 100.0 * profile.step);
    });
    return steps;
  };
  using Steps = std::vector<std::uint32_t>;
  CHECK(seen(agents::Privilege::none).empty());
  CHECK(seen(agents::Privilege::next_step) == Steps{1});
  CHECK(seen(agents::Privilege::whole_route) == Steps{1, 2, 3});
  flight.step({Action::hold}, "me");
  CHECK(seen(agents::Privilege::next_step) == Steps{2});
  CHECK(seen(agents::Privilege::whole_route).empty());
  flight.step({Action::hold}, "me");
  flight.step({Action::hold}, "me");
  CHECK(seen(agents::Privilege::next_step).empty());
}

TEST_CASE("the record names who flew each step") {
  SyntheticMap map = labelled(QosKind::spectral_efficiency, 4);
  Flight flight(map, 1, 0);
  flight.step({Action::up}, "a");
  flight.step({Action::hold, 0.0, agents::Introspection{0.5, 0.25, {1, 2, 3}}}, "b");
  flight.step({Action::down}, "a");
  const flight::FlightRecord& record = flight.record();
  CHECK(record.pilots == std::vector<std::string>{"a", "b"});
  CHECK(record.steps[0].flown_by == 0);
  CHECK(record.steps[1].flown_by == 1);
  CHECK(record.steps[2].flown_by == 0);
  CHECK(record.steps[1].introspection->epsilon == 0.5);
  CHECK_FALSE(record.steps[2].introspection);
}

TEST_CASE("flying an agent gives its whole record") {
  SyntheticMap map = labelled(QosKind::spectral_efficiency, 4);
  const agents::AgentSpec spec = spec_of("min-height");
  const auto record = flight::fly(map, 1, 0, *spec.make(), spec);
  CHECK(record.pilots == std::vector<std::string>{"min-height"});
  REQUIRE(record.steps.size() == 3);
  CHECK(record.qos_mean() == 200.0);
  CHECK(record.height_mean_m() == 40.0);
  CHECK(record.height_changes() == 0);
}

TEST_CASE("whole columns are read for foresight alone") {
  const auto columns_of = [](const char* agent) {
    SyntheticMap map = SyntheticMap::random(QosKind::spectral_efficiency, 12, 21, 3);
    const agents::AgentSpec spec = spec_of(agent);
    (void)flight::fly(map, 1, 0, *spec.make(), spec);
    return map.columns_read();
  };
  for (const char* agent : {"min-height", "constant-60", "random-walk", "height-filter", "local-bandit", "dqn"})
    CHECK(columns_of(agent) == 0);
  CHECK(columns_of("one-step-ahead") == 12);
  CHECK(columns_of("planner") == 12);
}
