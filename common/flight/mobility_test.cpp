// Sequences of places worked by hand. In most of them a step takes 0.2 s, one window of measurements, so that each step
// measures once, at its beginning: where the step before has led to.
#include "common/flight/mobility.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <stdexcept>
#include <vector>

using namespace aloft;
using flight::Mobility;
using radio::A3Rules;
using radio::CellReading;

namespace {

constexpr double qos_1 = 3.0;
constexpr double qos_2 = 5.0;
constexpr double qos_3 = 7.0;

/// Exact measurements without filter, and handovers that take no time.
A3Rules at_once() {
  return {.time_to_trigger_s = 0.0,
          .l3_filter_k = 0,
          .measurement_error_db = 0.0,
          .preparation_s = 0.0,
          .execution_s = 0.0};
}

using Place = std::vector<CellReading>;

/// Cell 1 at -80 dBm and cell 2; both have an SINR of 10 dB.
Place place(double power_2_dbm) {
  return {{1, -80.0, 10.0, qos_1}, {2, power_2_dbm, 10.0, qos_2}};
}

/// The same with other SINRs.
Place with_sinr(double power_2_dbm, double sinr_1_db, double sinr_2_db) {
  return {{1, -80.0, sinr_1_db, qos_1}, {2, power_2_dbm, sinr_2_db, qos_2}};
}

/// A UAV that begins at a place.
struct Uav {
  Uav(const A3Rules& rules, const Place& start, double step_s = 0.2, double outage_threshold_db = -6.0)
      : mobility(rules, 1, 0, step_s, outage_threshold_db) {
    mobility.begin(start);
  }
  Mobility::Passage to(const Place& there) { return mobility.pass(there); }
  /// The step, from 1, in which it is handed over, if it stays at a place for up to 50 steps; 0: in none.
  int handed_over_in_step(const Place& there) {
    for (int step = 1; step <= 50; ++step)
      if (to(there).events.handovers > 0) return step;
    return 0;
  }
  Mobility mobility;
};

constexpr double weak_dbm = -90.0;
constexpr double strong_dbm = -70.0;

}  // namespace

TEST_CASE("a flight begins at the strongest cell, and stays there without a stronger one") {
  Uav uav(A3Rules{}, place(weak_dbm), 1.0);
  CHECK(uav.mobility.serving() == 1);
  CHECK(Uav(A3Rules{}, place(strong_dbm)).mobility.serving() == 2);
  for (int step = 0; step < 20; ++step) {
    const Mobility::Passage passage = uav.to(place(weak_dbm));
    CHECK(passage.qos == qos_1);  // to the bit
    CHECK(passage.events == flight::MobilityEvents{});
  }
}

TEST_CASE("a handover is measured, triggered, prepared and executed at the times worked by hand") {
  Uav uav({.l3_filter_k = 0, .measurement_error_db = 0.0}, place(weak_dbm), 1.0);
  CHECK(uav.to(place(weak_dbm)).events.handovers == 0);
  // From 1 to 2 s cell 2 grows from -90 to -70 dBm: -90, -86, -82, -78 and -74 dBm at 1.0, 1.2, 1.4, 1.6 and 1.8 s.
  // Only the last exceeds -80 + 2 dBm. 0.16 s later, at 1.96 s, the handover is triggered, at 2.01 s commanded, at 2.05
  // s done.
  const Mobility::Passage before = uav.to(place(strong_dbm));
  CHECK(before.qos == qos_1);
  CHECK(before.events.handovers == 0);
  CHECK(uav.mobility.serving() == 1);
  CHECK(std::vector<std::int32_t>(uav.mobility.followed().begin(), uav.mobility.followed().end()) ==
        std::vector<std::int32_t>{1, 2});
  const Mobility::Passage after = uav.to(place(strong_dbm));
  CHECK(after.qos == Approx(0.01 * qos_1 + 0.95 * qos_2).epsilon(1e-12));
  CHECK(after.events.handovers == 1);
  CHECK(after.events.ping_pongs == 0);
  CHECK(after.events.outage_s == Approx(0.04).epsilon(1e-12));
  CHECK(uav.mobility.serving() == 2);
  CHECK(uav.to(place(strong_dbm)).qos == qos_2);
}

TEST_CASE("a neighbour enters above the offset, and leaves below it before the time to trigger") {
  A3Rules rules = at_once();
  CHECK(Uav(rules, place(weak_dbm)).handed_over_in_step(place(-78.0)) == 0);  // equal to -80 + 2 dBm
  CHECK(Uav(rules, place(weak_dbm)).handed_over_in_step(place(-77.9)) == 2);  // there at the second measurement
  rules.offset_db = -3.0;
  CHECK(Uav(rules, place(weak_dbm)).handed_over_in_step(place(-82.9)) == 2);
  rules.offset_db = 2.0;

  rules.time_to_trigger_s = 0.3;  // entered at 0.2 s: due at 0.5 s
  Uav gone(rules, place(weak_dbm));
  for (const double power_dbm : {strong_dbm, -78.1, strong_dbm, weak_dbm, weak_dbm})
    CHECK(gone.to(place(power_dbm)).events.handovers == 0);
  Uav at_the_bar(rules, place(weak_dbm));
  CHECK(at_the_bar.to(place(strong_dbm)).events.handovers == 0);  // 0 to 0.2 s
  CHECK(at_the_bar.to(place(-78.0)).events.handovers == 0);       // enters
  CHECK(at_the_bar.to(place(weak_dbm)).events.handovers == 1);    // neither leaves nor enters at the bar itself
}

TEST_CASE("the layer-3 filter forgets with 2^(-k/4) per measurement") {
  const auto step_with = [](int k) {
    A3Rules rules = at_once();
    rules.l3_filter_k = k;
    return Uav(rules, place(weak_dbm)).handed_over_in_step(place(strong_dbm));
  };
  // -90 dBm first, then -70 dBm: -70 - 20 (1 - a)^n after n more; above -78 dBm once (1 - a)^n < 0.4.
  CHECK(step_with(0) == 2);
  CHECK(step_with(1) == 2);    // a = 0.84: -73.2 dBm
  CHECK(step_with(4) == 3);    // a = 1/2: -80, -75 dBm
  CHECK(step_with(6) == 4);    // a = 0.354: 0.646, 0.418, 0.270
  CHECK(step_with(7) == 4);    // a = 0.297: 0.703, 0.494, 0.347
  CHECK(step_with(8) == 5);    // a = 1/4: 0.75, 0.56, 0.42, 0.32
  CHECK(step_with(19) == 26);  // a = 0.0372: n > ln 0.4 / ln 0.9628 = 24.2
}

TEST_CASE("the strongest of the neighbours that have triggered is the target") {
  const auto at = [](double power_2_dbm, double power_3_dbm) {
    Place there = place(power_2_dbm);
    there.push_back({3, power_3_dbm, 10.0, qos_3});
    return there;
  };
  Uav uav(at_once(), at(weak_dbm, weak_dbm));
  CHECK(uav.to(at(-75.0, -74.0)).events.handovers == 0);
  CHECK(uav.to(at(-75.0, -74.0)).events.handovers == 1);
  CHECK(uav.mobility.serving() == 3);

  A3Rules rules = at_once();
  rules.time_to_trigger_s = 0.3;  // cell 2 enters at 0.2 s, cell 3 at 0.4 s: at 0.5 s only cell 2 is due
  Uav first(rules, at(weak_dbm, weak_dbm));
  CHECK(first.to(at(-75.0, weak_dbm)).events.handovers == 0);
  CHECK(first.to(at(-75.0, -70.0)).events.handovers == 0);
  CHECK(first.to(at(-75.0, -70.0)).events.handovers == 1);
  CHECK(first.mobility.serving() == 2);
}

TEST_CASE("a ping-pong is a handover back to the former cell before the minimum stay") {
  const auto count = [](const A3Rules& rules) {
    Uav uav(rules, place(weak_dbm));
    flight::MobilityEvents sum;
    for (const double power_dbm : {strong_dbm, weak_dbm, weak_dbm}) {
      const Mobility::Passage passage = uav.to(place(power_dbm));
      sum.handovers += passage.events.handovers;
      sum.ping_pongs += passage.events.ping_pongs;
    }
    CHECK(sum.handovers == 2);  // to cell 2 at 0.2 s, and back at 0.4 s
    return sum.ping_pongs;
  };
  A3Rules rules = at_once();
  CHECK(count(rules) == 1);
  rules.minimum_stay_s = 0.2;
  CHECK(count(rules) == 0);
  rules.minimum_stay_s = 0.21;
  CHECK(count(rules) == 1);

  // From 1 to 2 to 3 is none, however short.
  const auto at = [](double power_2_dbm, double power_3_dbm) {
    Place there = place(power_2_dbm);
    there.push_back({3, power_3_dbm, 10.0, qos_3});
    return there;
  };
  Uav onward(at_once(), at(weak_dbm, weak_dbm));
  (void)onward.to(at(strong_dbm, weak_dbm));
  CHECK(onward.to(at(strong_dbm, -60.0)).events.handovers == 1);
  const Mobility::Passage second = onward.to(at(strong_dbm, -60.0));
  CHECK(second.events.handovers == 1);
  CHECK(second.events.ping_pongs == 0);
}

TEST_CASE("a link that stays out of sync for T310 fails, and is re-established at the strongest cell") {
  A3Rules rules = at_once();
  rules.offset_db = 15.0;  // no handover
  rules.t310_s = 1.0;
  rules.reestablishment_s = 0.25;
  const Place bad = with_sinr(-79.0, -8.1, 10.0);
  Uav uav(rules, place(weak_dbm), 0.4);
  for (int step = 0; step < 2; ++step) {
    const Mobility::Passage passage = uav.to(bad);  // 0 to 0.8 s
    CHECK(passage.qos == qos_1);
    CHECK(passage.events == flight::MobilityEvents{0, 0, 0, 0.4});
  }
  const Mobility::Passage failing = uav.to(bad);  // fails at 1 s
  CHECK(failing.qos == Approx(0.5 * qos_1).epsilon(1e-12));
  CHECK(failing.events == flight::MobilityEvents{0, 0, 1, 0.4});
  CHECK(uav.mobility.serving() == 2);
  const Mobility::Passage again = uav.to(bad);  // serves again from 1.25 s of 1.2 to 1.6 s
  CHECK(again.qos == Approx(0.35 / 0.4 * qos_2).epsilon(1e-12));
  CHECK(again.events.radio_link_failures == 0);
  CHECK(again.events.outage_s == Approx(0.05).epsilon(1e-12));

  // Qin ends the timer, an SINR between the two does not.
  const auto fails_within = [&](double sinr_db) {
    Uav other(rules, place(weak_dbm), 0.4);
    std::uint32_t failures = 0;
    for (const Place& there : {bad, with_sinr(weak_dbm, sinr_db, 10.0), bad})
      failures += other.to(there).events.radio_link_failures;
    return failures;
  };
  CHECK(fails_within(-6.0) == 0);
  CHECK(fails_within(-6.1) == 1);
  // At Qout itself nothing begins.
  Uav at_qout(rules, place(weak_dbm), 0.4);
  for (int step = 0; step < 10; ++step)
    CHECK(at_qout.to(with_sinr(weak_dbm, -8.0, 10.0)).events.radio_link_failures == 0);
}

TEST_CASE("a handover fails whose command or whose new cell cannot be heard") {
  A3Rules rules = at_once();
  rules.reestablishment_s = 0.1;
  for (const auto& [sinr_1_db, sinr_2_db] : {std::pair{-8.1, 10.0}, std::pair{10.0, -8.1}}) {
    Uav uav(rules, place(weak_dbm));
    CHECK(uav.to(place(strong_dbm)).events.radio_link_failures == 0);
    const Mobility::Passage passage = uav.to(with_sinr(strong_dbm, sinr_1_db, sinr_2_db));
    CHECK(passage.events.radio_link_failures == 1);
    CHECK(passage.events.handovers == 0);
    CHECK(uav.mobility.serving() == 2);  // the strongest
    CHECK(passage.qos == Approx(0.5 * qos_2).epsilon(1e-12));
  }
}

TEST_CASE("outage is the time below its threshold") {
  Uav uav(A3Rules{}, place(weak_dbm), 1.0, 3.0);
  CHECK(uav.to(with_sinr(weak_dbm, 3.0, 0.0)).events.outage_s == 0.0);
  CHECK(uav.to(with_sinr(weak_dbm, 2.9, 0.0)).events.outage_s == 1.0);
}

TEST_CASE("cells that are not heard for a while are measured afresh, and followed ones must be heard") {
  A3Rules rules = at_once();
  rules.l3_filter_k = 8;  // -90 dBm would hold the filter down for five measurements
  Uav uav(rules, place(weak_dbm));
  (void)uav.to(place(weak_dbm));
  (void)uav.to({place(weak_dbm).front()});
  CHECK(uav.to(place(strong_dbm)).events.handovers == 1);
  CHECK_THROWS_AS(uav.to({place(weak_dbm).front()}), std::logic_error);
}

TEST_CASE("measurement errors are normal, and the same for the same seed, trial, time and cell") {
  // Cell 2 is below the bar by sqrt(2) standard deviations of an error: the difference of two errors exceeds that, one
  // of its own standard deviations, with a probability of 0.158655.
  A3Rules rules = at_once();
  rules.measurement_error_db = 1.22;
  const Place there = place(-78.0 - std::sqrt(2.0) * 1.22);
  const auto handed_over = [&](std::uint64_t seed, std::uint32_t trial) {
    Mobility mobility(rules, seed, trial, 0.2, -6.0);
    mobility.begin(place(weak_dbm));
    CHECK(mobility.pass(there).events.handovers == 0);  // measures at -90 dBm
    return mobility.pass(there).events.handovers;
  };
  constexpr std::uint32_t trials = 10'000;
  std::uint32_t sum = 0;
  std::uint32_t other_seed = 0;
  for (std::uint32_t trial = 0; trial < trials; ++trial) {
    sum += handed_over(1, trial);
    other_seed += handed_over(2, trial) != handed_over(1, trial) ? 1 : 0;
    CHECK(handed_over(1, trial) == handed_over(1, trial));
  }
  constexpr double share = 0.158655;
  CHECK(sum == Approx(share * trials).margin(3.0 * std::sqrt(share * (1.0 - share) * trials)));
  CHECK(other_seed > trials / 5);  // 2 x 0.16 x 0.84 = 0.27
}
