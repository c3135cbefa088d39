#include "common/flight/energy.hpp"

#include <catch2/catch.hpp>

#include "common/flight/flight.hpp"

using namespace aloft;
using flight::level_power_w;
using flight::step_energy_j;

// Worked out by hand from eq. (12) and table I of the paper, which gives P0 = 79.86 W and Pi = 88.63 W.
TEST_CASE("hovering takes the blade profile power and the induced power of the paper") {
  CHECK(level_power_w(0.0) == Approx(79.8563 + 88.6279).epsilon(1e-5));
}

TEST_CASE("the power of level flight at 10 m/s, term by term") {
  // Blades 79.8563 (1 + 3 * 100 / 14400) = 81.5200. Induced: 100 / (2 * 4.03^2) = 3.078647, sqrt(1 + 3.078647^2) =
  // 3.236984, 88.6279 sqrt(3.236984 - 3.078647) = 35.2665. Parasite 0.5 * 0.6 * 1.225 * 0.05 * 0.503 * 1000 = 9.2426.
  CHECK(level_power_w(10.0) == Approx(81.5200 + 35.2665 + 9.2426).epsilon(1e-5));
}

TEST_CASE("the speeds of longest endurance and longest range are those of the paper's figure 2") {
  double endurance_m_per_s = 0.1;
  double range_m_per_s = 0.1;
  for (int i = 1; i <= 400; ++i) {
    const double speed = 0.1 * i;
    if (level_power_w(speed) < level_power_w(endurance_m_per_s)) endurance_m_per_s = speed;
    if (level_power_w(speed) / speed < level_power_w(range_m_per_s) / range_m_per_s) range_m_per_s = speed;
  }
  CHECK(endurance_m_per_s == Approx(10.2));
  CHECK(level_power_w(endurance_m_per_s) == Approx(126.0).margin(0.05));
  CHECK(range_m_per_s == Approx(18.3));
  CHECK(level_power_w(range_m_per_s) == Approx(161.6).margin(0.05));
}

TEST_CASE("a step costs its duration in level flight, and climbing comes on top") {
  CHECK(step_energy_j({}, 0.0) == Approx(126.029).epsilon(1e-5));                            // 1 s
  CHECK(step_energy_j({.speed_m_per_s = 20.0}, 0.0) == Approx(178.2958 / 2).epsilon(1e-5));  // half a second
  CHECK(step_energy_j({.step_length_m = 5.0}, 0.0) == Approx(126.029 / 2).epsilon(1e-5));
  // 20 N * 10 m / 0.7 = 285.714 J.
  CHECK(step_energy_j({}, 10.0) == Approx(126.029 + 285.714).epsilon(1e-5));
  CHECK(step_energy_j({}, -10.0) == step_energy_j({}, 0.0));
}

TEST_CASE("a record computes the energy and the handovers of its flight") {
  flight::FlightRecord record;
  record.height_start_m = 40.0;
  CHECK_FALSE(record.handovers().has_value());
  const auto add = [&](double height_m, std::int32_t cell) {
    flight::StepRecord step;
    step.height_m = height_m;
    step.serving_cell = cell;
    record.steps.push_back(step);
  };
  add(40.0, -1);
  CHECK_FALSE(record.handovers().has_value());  // unknown, not 0
  add(60.0, 3);
  CHECK(record.handovers() == 0U);  // the first that is known
  add(50.0, -1);
  add(50.0, 3);
  CHECK(record.handovers() == 0U);
  add(70.0, 8);
  add(70.0, 3);
  CHECK(record.handovers() == 2U);
  CHECK(record.energy_j({}) == Approx(6 * 126.029 + 20.0 * (20.0 + 20.0) / 0.7).epsilon(1e-5));
  CHECK(record.step_energy_j(1, {}) == step_energy_j({}, 20.0));
}
