#include "common/radio/report_likelihood.hpp"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <functional>
#include <nlohmann/json.hpp>
#include <numeric>

#include "common/base/random.hpp"
#include "common/radio/generated_world.hpp"
#include "common/radio/testing/plain_radio.hpp"
#include "common/world/city.hpp"

using namespace aloft;
using aloft::radio::PlainRadio;
using aloft::radio::ReportLikelihood;
using nlohmann::json;
using Report = ReportLikelihood::Report;

namespace {

Parameters world_with(const json& given) {
  return radio::resolve_generated_world(given, "world");
}

std::vector<world::Site> sites_at(const std::vector<world::Position>& positions) {
  std::vector<world::Site> sites;
  for (const world::Position& position : positions)
    sites.push_back({static_cast<std::int32_t>(sites.size()), position, 37.0 * static_cast<double>(sites.size() % 10)});
  return sites;
}

const double noise_w = std::pow(10.0, (-174 + 10 * std::log10(20e6) + 10) / 10) / 1000;

/// The likelihood by its definition: 5 candidates, every order of them tried for the neighbours.
class PlainLikelihood {
 public:
  PlainLikelihood(const Parameters& world, const std::vector<world::Site>& sites)
      : radio_(world, sites), stations_(sites.size()) {}

  [[nodiscard]] double of(const Report& report) const {
    std::vector<std::size_t> order(stations_);
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::stable_sort(order.begin(), order.end(),
                     [&](auto a, auto b) { return power_w(report, a) > power_w(report, b); });
    const auto serving = std::ranges::find(order, report.serving);
    const double surprise = serving - order.begin() < 5 ? 1.0 : 0.01;
    order.erase(serving);
    order.resize(std::min<std::size_t>(order.size(), 4));
    std::ranges::sort(order);
    const std::size_t neighbours = std::min<std::size_t>(report.sinrs - 1, order.size());
    double sum = 0.0;
    double ways = 0.0;
    do {
      double product = 1.0;
      for (std::size_t i = 0; i < order.size(); ++i)
        product *= i < neighbours ? density(report, order[i], report.sinr[i + 1])
                                  : 0.995 * (1.0 - exceeds(report, order[i], report.sinr[report.sinrs - 1])) + 0.0025;
      sum += product;
      ++ways;
    } while (std::ranges::next_permutation(order).found);
    double different_ways = 1.0;  // orders of those that are not assigned are the same way
    for (std::size_t i = 0; i < neighbours; ++i) different_ways *= static_cast<double>(order.size() - i);
    return surprise * density(report, report.serving, report.sinr[0]) * sum / ways * different_ways;
  }

 private:
  [[nodiscard]] double power_w(const Report& report, std::size_t k) const {
    return radio_.power_w(report.place, k, report.height_m);
  }

  [[nodiscard]] double exceeds(const Report& report, std::size_t c, double x) const {
    double product = std::exp(-noise_w * x / power_w(report, c));
    for (std::size_t k = 0; k < stations_; ++k)
      if (k != c && radio_.interferes(report.place, c, k, report.height_m))
        product /= 1.0 + x * power_w(report, k) / power_w(report, c);
    return product;
  }

  /// -d/du of P(log2(1 + SINR) > u), by its difference.
  [[nodiscard]] double density(const Report& report, std::size_t c, double x) const {
    const double h = 1e-5;
    const auto at = [&](double u) { return exceeds(report, c, std::exp2(u) - 1.0); };
    const double u = std::log2(1.0 + x);
    return 0.995 * (at(u - h) - at(u + h)) / (2 * h) + 0.005 / 25.0;
  }

  PlainRadio radio_;
  std::size_t stations_;
};

Report random_report(RandomStream& random, std::size_t stations, std::uint32_t neighbours) {
  Report report;
  report.place = {random.uniform(-500.0, 500.0), random.uniform(-10.0, 10.0)};
  report.height_m = 40.0 + 10.0 * random.uniform_index(21);
  report.serving = random.uniform_index(static_cast<std::uint32_t>(stations));
  report.sinrs = neighbours + 1;
  std::vector<double> sinr;
  for (std::uint32_t i = 0; i < report.sinrs; ++i) sinr.push_back(std::pow(10.0, random.uniform(-1.0, 3.0)));
  std::ranges::sort(sinr, std::greater<>());
  std::ranges::copy(sinr, report.sinr.begin());
  return report;
}

}  // namespace

TEST_CASE("a report of the only station, by hand") {
  // At 40 m, 100 m from the mast: D = sqrt(100^2 + 10^2) = 100.499 m, s = 10 / D = 0.099504, 8 cos x cos 2x cos 4x with
  // x = pi s / 2 = 0.156300: 8 * 0.987810 * 0.951538 * 0.810849 = 6.097254, g = 6.097254^2 / 8 = 4.647063.
  // G = 16 pi / (pi/4)^2 = 81.4873, K = (3e8 / (4 pi 3.5e9))^2 = 4.652593e-5, D^-2.1 = 6.244288e-5.
  // p = 40 G K g D^-2.1 = 4.4005e-5 W. N = 7.962e-13 W; at x = 5e7: N x / p = 0.90467.
  // Density in u: 0.995 exp(-0.90467) (N / p) (1 + x) ln 2 + 0.005 / 25 = 0.2527.
  const ReportLikelihood likelihood(world_with(json::object()), sites_at({{100, 0}}));
  const Report report{{0, 0}, 40.0, 0, 1, {5e7}};
  ReportLikelihood::View view;
  likelihood.look(report, std::vector<world::Position>{{100, 0}}, view);
  CHECK(view.power_w[0] == Approx(4.4005e-5).epsilon(1e-3));
  CHECK(view.evaluation.likelihood == Approx(0.2527).epsilon(2e-3));
}

TEST_CASE("the likelihood is what its definition says") {
  for (const json& given : {json::object(), json{{"bs_antenna", "sector"}}, json{{"uav_antenna", "omnidirectional"}}}) {
    const Parameters world = world_with(given);
    RandomStream random(3, 0, "reports");
    for (const std::uint32_t neighbours : {4U, 2U, 0U, 5U}) {
      for (std::uint32_t trial = 0; trial < 4; ++trial) {
        const std::vector<world::Position> stations = world::generate_city(world, 7, trial).base_stations;
        const ReportLikelihood likelihood(world, sites_at(stations));
        const PlainLikelihood plain(world, sites_at(stations));
        for (int i = 0; i < 20; ++i) {
          const Report report = random_report(random, stations.size(), neighbours);
          ReportLikelihood::View view;
          likelihood.look(report, stations, view);
          INFO(given.dump() << ", " << neighbours << " neighbours, trial " << trial << ", report " << i);
          CHECK(view.evaluation.likelihood == Approx(plain.of(report)).epsilon(1e-5));
        }
      }
    }
  }
}

TEST_CASE("after any moves, taken back or not, a view has the same bits as a new one") {
  const Parameters world = world_with({{"bs_density_per_km2", 5}});
  std::vector<world::Position> stations = world::generate_city(world, 7, 0).base_stations;
  const ReportLikelihood likelihood(world, sites_at(stations));
  RandomStream random(4, 0, "moves");
  const Report report = random_report(random, stations.size(), 4);
  ReportLikelihood::View moved;
  likelihood.look(report, stations, moved);
  for (int i = 0; i < 2000; ++i) {
    const std::uint32_t k = random.uniform_index(static_cast<std::uint32_t>(stations.size()));
    const world::Position to{stations[k].x_m + 200.0 * random.normal(), stations[k].y_m + 200.0 * random.normal()};
    ReportLikelihood::Undo undo;
    likelihood.move(report, k, to, moved, undo);
    if (i % 3 == 0)
      ReportLikelihood::take_back(undo, k, moved);
    else
      stations[k] = to;
    ReportLikelihood::View fresh;
    likelihood.look(report, stations, fresh);
    REQUIRE(moved.evaluation.likelihood == fresh.evaluation.likelihood);
    for (std::uint32_t j = 0; j < stations.size(); ++j)
      REQUIRE(likelihood.matters(moved, j) == likelihood.matters(fresh, j));
  }
}
