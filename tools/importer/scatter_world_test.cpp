#include "tools/importer/scatter_world.hpp"

#include <catch2/catch.hpp>
#include <cmath>

#include "common/base/error.hpp"
#include "common/world/measured_flight.hpp"

using namespace aloft;
using namespace aloft::importer;
using Catch::Contains;

namespace {

/// Samples on the equator, around 0 degrees east.
Scatter scatter_of(Quantity quantity, std::vector<Sample> samples) {
  return {quantity, true, true, {0.0, 0.0}, std::move(samples)};
}

Sample at(double x_m, double height_m, double value, std::int32_t cell = 1, double time_s = 0.0) {
  return {.position = {x_m, 0.0}, .height_m = height_m, .value = value, .cell = cell, .time_s = time_s};
}

/// Two heights, one sample every 10 m along 20 m.
std::vector<Sample> six_samples() {
  return {at(0, 20, 1),          at(10, 20, 2, 1, 10),   at(20, 20, 3, 1, 20),
          at(0, 30, 11, 2, 100), at(10, 30, 12, 2, 110), at(20, 30, 13, 2, 120)};
}

ScatterOptions options_of(double radius_m, double height_radius_m) {
  ScatterOptions options;
  options.reach = {radius_m, height_radius_m};
  return options;
}

std::string error_of(const Scatter& scatter, const ScatterOptions& options) {
  try {
    static_cast<void>(scatter_world(scatter, options, "log.csv"));
  } catch (const InputError& error) {
    return error.what();
  }
  return "accepted";
}

}  // namespace

TEST_CASE("a value is the mean of its cell's samples in reach, weighted by the inverse square of the distance") {
  const std::vector<Sample> samples{at(3, 20, 10), at(-6, 20, 40), at(0, 24, 100), at(0, 20, 5, 2), at(100, 20, 7)};
  const ScatterField field(samples, {50.0, 10.0});
  const CellValues found = field.at({0, 0}, 20.0);
  REQUIRE(found.by_cell.size() == 2);
  // (10 / 9 + 40 / 36 + 100 / 16) / (1 / 9 + 1 / 36 + 1 / 16) = 1220 / 29; the sample 100 m away is out of reach
  CHECK(found.of(1).value() == Approx(1220.0 / 29.0).epsilon(1e-12));
  CHECK(found.of(2) == 5.0);  // 0 m counts as 1 m
  CHECK(found.nearest_cell == 2);
  CHECK_FALSE(found.of(3).has_value());
  // without the samples of cell 2, the nearest is one of cell 1
  const CellValues without = field.at({0, 0}, 20.0, [](const Sample& sample) { return sample.cell == 2; });
  CHECK(without.nearest_cell == 1);
  CHECK_FALSE(without.of(2).has_value());
  CHECK(ScatterField(samples, {50.0, 3.0}).at({0, 0}, 20.0).of(1).value() == Approx(16.0));  // (10/9+40/36)/(5/36)
  CHECK(field.at({0, 0}, 31.0).by_cell.size() == 1);
  CHECK(field.at({0, 500}, 20.0).by_cell.empty());
}

TEST_CASE("samples in reach are found wherever the place is: compared with a search through all of them") {
  std::vector<Sample> samples;
  for (int i = 0; i < 300; ++i)
    samples.push_back({.position = {std::fmod(i * 37.7, 211.0) - 105.0, std::fmod(i * 91.3, 173.0) - 80.0},
                       .height_m = 20.0 + i % 30,
                       .value = std::fmod(i * 7.3, 40.0),
                       .cell = i % 3});
  const ScatterField field(samples, {23.0, 8.0});
  int with_samples = 0;
  for (double x_m = -130.0; x_m <= 130.0; x_m += 13.0)
    for (double y_m = -110.0; y_m <= 110.0; y_m += 11.0) {
      double weight = 0.0;
      double sum = 0.0;
      for (const Sample& sample : samples) {
        const double ground_m = std::hypot(sample.position.x_m - x_m, sample.position.y_m - y_m);
        const double rise_m = sample.height_m - 31.0;
        if (sample.cell != 1 || ground_m > 23.0 || std::abs(rise_m) > 8.0) continue;
        const double square = std::max(1.0, ground_m * ground_m + rise_m * rise_m);
        weight += 1.0 / square;
        sum += sample.value / square;
      }
      const auto found = field.at({x_m, y_m}, 31.0).of(1);
      REQUIRE(found.has_value() == (weight > 0.0));
      if (found) REQUIRE(*found == Approx(sum / weight).epsilon(1e-9));
      with_samples += found ? 1 : 0;
    }
  CHECK(with_samples > 100);
}

TEST_CASE("without a route, steps follow the lowest samples in order of time") {
  std::vector<Sample> samples = six_samples();
  std::swap(samples[0], samples[2]);  // the file has them backwards, their times do not
  const ImportedWorld world = scatter_world(scatter_of(Quantity::sinr_db, samples), options_of(4.0, 4.0), "x");
  REQUIRE(world.route.size() == 3);
  CHECK(world.height_m == std::vector<double>{20, 30});
  CHECK(world.route[0].longitude_deg == Approx(0.0).margin(1e-9));
  CHECK(world.route[2].longitude_deg == Approx(20.0 / 111'319.49).epsilon(1e-6));
  std::vector<double> sinr_db;
  for (const ImportedValue& value : world.values) sinr_db.push_back(value.sinr_db);
  CHECK(sinr_db == std::vector<double>{1, 11, 2, 12, 3, 13});
  CHECK(world.values[1].serving_cell == 2);
  CHECK(world.values[0].throughput_kbps == Approx(1e4 * std::log2(1.0 + std::pow(10.0, 0.1))));
  const world::MeasuredFlight flight = world::parse_measured_flight(to_csv(world), "x");
  CHECK(flight.steps == 3);
  CHECK(flight.serving_cell == std::vector<std::int32_t>{1, 2, 1, 2, 1, 2});
}

TEST_CASE("a route of one's own counts in degrees") {
  ScatterOptions options = options_of(4.0, 4.0);
  options.route = {{0.0, 0.0}, {0.0, 10.0 / 111'319.49}};
  CHECK(scatter_world(scatter_of(Quantity::sinr_db, six_samples()), options, "x").route.size() == 2);
  options.route = {{91.0, 0.0}};
  CHECK_THAT(error_of(scatter_of(Quantity::sinr_db, six_samples()), options), Contains("--route 91,0"));
}

TEST_CASE("throughputs stay as they are, and RSRQ and RSRP become SINR") {
  std::vector<Sample> samples = six_samples();
  for (Sample& sample : samples) sample.value *= 1000;
  const ImportedWorld rates = scatter_world(scatter_of(Quantity::throughput_kbps, samples), options_of(4, 4), "x");
  CHECK(rates.values[5].throughput_kbps == 13'000.0);
  CHECK_FALSE(rates.has_sinr);
  for (Sample& sample : samples) sample.value = -13.8021;  // 0 dB under full load
  const ImportedWorld rsrq = scatter_world(scatter_of(Quantity::rsrq_db, samples), options_of(4, 4), "x");
  CHECK(rsrq.values[0].sinr_db == Approx(0.0).margin(1e-4));
  CHECK(rsrq.values[0].throughput_kbps == Approx(1e4).epsilon(1e-4));

  // Two cells everywhere, heard at -80 and -90 dBm; noise of 15 kHz at -123.24 dBm hardly counts: 10 dB less 0.002.
  samples = six_samples();
  for (Sample& sample : samples) sample.value = -90.0;
  for (Sample sample : six_samples()) {
    sample.cell = 9;
    sample.value = -80.0;
    samples.push_back(sample);
  }
  const ImportedWorld rsrp = scatter_world(scatter_of(Quantity::rsrp_dbm, samples), options_of(4, 4), "x");
  CHECK(rsrp.values[3].serving_cell == 9);
  CHECK(rsrp.values[3].sinr_db == Approx(9.998).margin(5e-4));
}

TEST_CASE("holes take the value of the nearest step at that height and are marked, or are refused") {
  std::vector<Sample> samples = six_samples();
  samples.erase(samples.begin() + 4);  // 10 m, 30 m high
  const Scatter scatter = scatter_of(Quantity::sinr_db, samples);
  const ImportedWorld world = scatter_world(scatter, options_of(4, 4), "x");
  CHECK(world.values[3].sinr_db == 11.0);  // of the earlier one of two
  CHECK_FALSE(world.values[3].observed);
  CHECK(world.values[1].observed);
  ScatterOptions strict = options_of(4, 4);
  strict.hole_max_m = 5.0;
  CHECK_THAT(error_of(scatter, strict),
             Contains("log.csv: a hole at step 2 (") && Contains("30 m: no sample within") && Contains("--hole-max"));
  ScatterOptions high = options_of(4, 4);
  high.heights.max_m = 40.0;
  CHECK_THAT(error_of(scatter, high), Contains("a hole at step 1") && Contains("40 m"));
  ScatterOptions low = options_of(4, 4);
  low.heights.min_m = 10.0;
  CHECK_THAT(error_of(scatter, low), Contains("no samples within 5 m of 10 m") && Contains("--route"));
}

TEST_CASE("the held-out error: each sample is predicted from those far enough in time") {
  // Along x, 10 s apart: each is predicted from its neighbours, 10 m away; those at the ends from one.
  const Scatter line = scatter_of(
      Quantity::sinr_db, {at(0, 20, 1, 1, 0), at(10, 20, 2, 1, 10), at(20, 20, 6, 1, 20), at(500, 20, 9, 2, 30)});
  ScatterOptions options = options_of(15.0, 5.0);
  options.apart_s = 5.0;
  // predictions 2, (1 + 6) / 2, 2, none: errors +1, +1.5, -4
  const HeldOut error = held_out_error(line, options);
  CHECK(error.all.samples == 4);
  CHECK(error.all.predicted == 3);
  CHECK(error.all.mean == Approx(-0.5));
  CHECK(error.all.root_mean_square == Approx(std::sqrt((1.0 + 2.25 + 16.0) / 3.0)));
  REQUIRE(error.by_cell.size() == 2);
  CHECK(error.by_cell[0].predicted == 3);
  CHECK(error.by_cell[1].predicted == 0);
  CHECK(error.by_cell[1].root_mean_square == 0.0);
  options.apart_s = 10.5;  // no longer far enough
  CHECK(held_out_error(line, options).all.predicted == 0);
  Scatter timeless = line;
  timeless.has_times = false;
  CHECK(held_out_error(timeless, options).all.predicted == 3);
}

TEST_CASE("the held-out error of RSRP is that of the same cell, whichever is nearest") {
  Scatter scatter = scatter_of(Quantity::rsrp_dbm, {at(0, 20, -80, 1), at(1, 20, -95, 2), at(10, 20, -84, 1)});
  scatter.has_times = false;
  const HeldOut error = held_out_error(scatter, options_of(50, 5));
  CHECK(error.by_cell[0].root_mean_square == Approx(4.0));
  CHECK(error.by_cell[1].predicted == 0);
}
