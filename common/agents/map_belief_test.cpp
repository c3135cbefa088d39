#include "common/agents/map_belief.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <vector>

#include "common/agents/steering.hpp"
#include "common/base/error.hpp"

using namespace aloft;
using namespace aloft::agents;

namespace {

/// Two maps and two levels. Steps 3 and 4: map 0 expects 1 and 2 bit/s/Hz, map 1 five times as much.
MapBelief belief() {
  MapBelief made(2, 2);
  made.expect(3, {1, 2, 5, 10});
  made.expect(4, {1, 2, 5, 10});
  return made;
}

/// The SINR at which log2(1 + SINR) is this.
double sinr_db(double bits) {
  return 10.0 * std::log10(std::exp2(bits) - 1.0);
}

double likelihood(double deviation_bits) {
  return 0.02 + std::exp(-0.5 * deviation_bits * deviation_bits / (1.85 * 1.85));
}

/// Of map 1 by its log-weight relative to map 0.
double share(double log_odds) {
  return 1.0 / (1.0 + std::exp(-log_odds));
}

constexpr double tolerance = 1e-6;  // columns are floats

}  // namespace

TEST_CASE("without reports all maps weigh the same") {
  CHECK(belief().mean_columns(3, 2) == std::vector<double>{3, 6, 3, 6});
  CHECK(belief().mean_columns(4, 1) == std::vector<double>{3, 6});
}

TEST_CASE("a report weighs the maps by a normal distribution of log2(1 + SINR) around what they expect") {
  MapBelief made = belief();
  made.learn(3, 0, sinr_db(4.0));  // 3 bits from map 0, 1 bit from map 1
  double log_odds = std::log(likelihood(1.0) / likelihood(3.0));
  const auto mean = [&] { return made.mean_columns(4, 1); };
  CHECK(mean()[0] == Approx(1.0 + 4.0 * share(log_odds)).epsilon(tolerance));
  CHECK(mean()[1] == Approx(2.0 + 8.0 * share(log_odds)).epsilon(tolerance));
  made.learn(4, 1, sinr_db(3.0));  // 1 bit from map 0, 7 bits from map 1; the first report counts 0.8
  log_odds = 0.8 * log_odds + std::log(likelihood(7.0) / likelihood(1.0));
  CHECK(mean()[0] == Approx(1.0 + 4.0 * share(log_odds)).epsilon(tolerance));
}

TEST_CASE("a report that no map explains, however extreme, leaves all maps possible") {
  for (const double extreme_db : {-1e6, -1000.0, 1000.0, 1e6}) {
    MapBelief made = belief();
    for (int i = 0; i < 1000; ++i) made.learn(3, 1, extreme_db);
    const double mean = made.mean_columns(3, 1)[0];
    CHECK(mean > 1.0 - tolerance);
    CHECK(mean < 5.0 + tolerance);
  }
}

TEST_CASE("reports of steps whose columns are unknown change nothing") {
  MapBelief made = belief();
  for (const std::uint32_t step : {0U, 2U, 5U}) made.learn(step, 0, sinr_db(1.0));
  made.forget_before(4);
  made.learn(3, 0, sinr_db(1.0));
  CHECK(made.mean_columns(4, 1) == std::vector<double>{3, 6});
}

TEST_CASE("columns of a step after a gap replace those before it") {
  MapBelief made = belief();
  made.expect(9, {0, 0, 2, 4});
  CHECK(made.first_step() == 9);
  CHECK(made.steps() == 1);
  CHECK(made.mean_columns(9, 1) == std::vector<double>{1, 2});
}

TEST_CASE("the weights of maps are saved and restored; impossible ones are refused") {
  MapBelief made = belief();
  made.learn(3, 0, sinr_db(4.0));
  const Parameters none{std::vector<ParameterSpec>{}};
  const auto state = [&](const auto& put) {
    StateWriter writer("x", none);
    put(writer);
    return writer.bytes();
  };
  MapBelief other = belief();
  other.restore(StateReader(state([&](StateWriter& writer) { made.save(writer); }), "x", none));
  CHECK(other.mean_columns(3, 2) == made.mean_columns(3, 2));
  for (const std::vector<double>& weights : {std::vector<double>{0}, {0, NAN}, {0, 1e9}}) {
    const std::string bytes = state([&](StateWriter& writer) { writer.put("map_weights", std::span(weights)); });
    CHECK_THROWS_AS(other.restore(StateReader(bytes, "x", none)), IntegrityError);
  }
}
