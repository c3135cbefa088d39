#include "common/radio/generated_map.hpp"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <nlohmann/json.hpp>
#include <numeric>
#include <optional>

#include "common/base/random.hpp"
#include "common/radio/generated_world.hpp"
#include "common/world/city.hpp"

using namespace aloft;
using nlohmann::json;

namespace {

constexpr std::uint64_t seed = 42;
constexpr std::uint32_t trial = 3;
const double pi = std::acos(-1.0);

struct Sinr {
  std::uint32_t station;
  double power_w;
  double sinr;
};

/// A direct implementation of the radio model, one place at a time, with the C library's functions. Parameters that are
/// not read from `given` have their defaults.
class PlainRadio {
 public:
  PlainRadio(const json& given, const world::City& city)
      : city_(city), world_(radio::resolve_generated_world(given, "world")) {
    RandomStream azimuths(seed, trial, "sector azimuth");
    for (std::size_t k = 0; k < city.base_stations.size(); ++k) azimuths_.push_back(pi * azimuths.uniform(-1.0, 1.0));
  }

  /// SINR of the wanted stations, strongest power first.
  [[nodiscard]] std::vector<Sinr> sinrs(std::uint32_t point, world::Position uav, double h) const {
    const auto n = static_cast<std::uint32_t>(city_.base_stations.size());
    std::vector<std::uint32_t> order(n);
    std::iota(order.begin(), order.end(), 0U);
    std::vector<double> p(n);
    for (std::uint32_t k = 0; k < n; ++k) p[k] = power(uav, k, h);
    std::stable_sort(order.begin(), order.end(), [&](auto a, auto b) { return p[a] > p[b]; });
    if (world_.text("serving_selection") != "best-of-all")
      order.resize(std::max<std::size_t>(5, static_cast<std::size_t>(world_.integer("neighbours")) + 1));
    std::vector<Sinr> result;
    for (const std::uint32_t c : order) {
      double below = std::pow(10.0, (-174 + 10 * std::log10(20e6) + 10) / 10) / 1000;
      for (std::uint32_t k = 0; k < n; ++k)
        if (k != c && interferes(uav, c, k, h)) below += p[k] * fading(point, c, k, h);
      result.push_back({c, p[c], p[c] * fading(point, c, c, h) / below});
    }
    return result;
  }

 private:
  [[nodiscard]] double distance(world::Position uav, std::uint32_t k) const {
    return std::hypot(city_.base_stations[k].x_m - uav.x_m, city_.base_stations[k].y_m - uav.y_m);
  }
  [[nodiscard]] double azimuth(world::Position uav, std::uint32_t k) const {
    return std::atan2(city_.base_stations[k].y_m - uav.y_m, city_.base_stations[k].x_m - uav.x_m);
  }
  static double apart(double a, double b) { return std::fabs(std::remainder(a - b, 2 * pi)); }

  [[nodiscard]] bool line_of_sight(world::Position uav, std::uint32_t k, double h) const {
    const double r = distance(uav, k);
    const double a = azimuth(uav, k);
    for (std::uint32_t iy = 0; iy < city_.buildings_y; ++iy) {
      for (std::uint32_t ix = 0; ix < city_.buildings_x; ++ix) {
        const world::Position b = city_.building_centre(ix, iy);
        const double lx = (b.x_m - uav.x_m) * std::cos(a) + (b.y_m - uav.y_m) * std::sin(a);
        const double ly = -(b.x_m - uav.x_m) * std::sin(a) + (b.y_m - uav.y_m) * std::cos(a);
        if (lx <= 0 || lx >= r || std::fabs(ly) > 28.284271247461902) continue;
        const double ray = world_.text("los_ray") == "published" ? 30 + (h - 30) * lx / r : h + (30 - h) * lx / r;
        if (city_.building_height_m[iy * city_.buildings_x + ix] > ray) return false;
      }
    }
    return true;
  }

  [[nodiscard]] double power(world::Position uav, std::uint32_t k, double h) const {
    const double r = distance(uav, k);
    const double d = std::hypot(r, h - 30);
    const double s = (h - 30) / d;
    const double g = std::pow(std::sin(4 * pi * s) / std::sin(pi * s / 2), 2) / 8;
    const double beam = 16 * pi / std::pow(pi / 4, 2);
    const double k0 = std::pow(3e8 / (4 * pi * 3.5e9), 2);
    const double uav_gain = world_.text("uav_antenna") == "directional" ? beam : 1.0;
    const double bs_gain = world_.text("bs_antenna") == "array" ? g : beam;
    const double path_m = world_.text("path_distance") == "slant" ? d : r;
    return 40 * uav_gain * bs_gain * k0 * std::pow(path_m, line_of_sight(uav, k, h) ? -2.1 : -4.0);
  }

  [[nodiscard]] bool interferes(world::Position uav, std::uint32_t c, std::uint32_t k, double h) const {
    if (world_.text("bs_antenna") == "sector" && apart(azimuth(uav, k) + pi, azimuths_[k]) >= pi / 8) return false;
    if (world_.text("uav_antenna") == "omnidirectional") return true;
    if (apart(azimuth(uav, c), azimuth(uav, k)) >= pi / 8) return false;
    const double theta = std::atan2(h - 30, distance(uav, c));
    const double lt = theta < pi / 2 - pi / 8 ? (h - 30) / std::tan(theta + pi / 8) : 0.0;
    double ut = 3000;
    if (theta > pi / 2 - pi / 8)
      ut = h - 30;
    else if (theta > pi / 8)
      ut = (h - 30) / std::tan(theta - pi / 8);
    return distance(uav, k) >= lt && distance(uav, k) <= ut;
  }

  [[nodiscard]] double fading(std::uint32_t point, std::uint32_t c, std::uint32_t k, double h) const {
    const RandomStream stream(seed, trial, "fading");
    if (world_.text("fading") == "none") return 1.0;
    const auto height = static_cast<std::uint32_t>(std::lround(h - 40));
    if (world_.text("fading") == "correlated")  // constant over height: |amplitude|^2 of the first
      return -std::log((stream.block(point, c * 65536 + k, 0)[0] + 0.5) / 4294967296.0);
    return -std::log((stream.block(point, c * 65536 + k, height / 4).at(height % 4) + 0.5) / 4294967296.0);
  }

  const world::City& city_;
  Parameters world_;
  std::vector<double> azimuths_;
};

/// Compares a map with the direct implementation at some points and heights.
void check_against_plain(const json& given) {
  const Parameters world = radio::resolve_generated_world(given, "world");
  const world::City city = world::generate_city(world, seed, trial);
  const auto map = radio::make_generated_map(world, city, seed, trial);
  const PlainRadio plain(given, city);
  const auto neighbours = static_cast<std::size_t>(world.integer("neighbours"));
  for (std::uint32_t point = 0; point <= map->steps(); point += 20) {
    const world::Position uav = map->advance(point, map->start(), -1);
    const auto& column = map->column(point, uav);
    for (std::uint32_t i = 0; i < column.size(); i += 3) {
      const std::vector<Sinr> all = plain.sinrs(point, uav, map->heights().height_m(i));
      const std::size_t candidates = world.text("serving_selection") == "best-of-all" ? all.size() : 5;
      const auto serving = std::max_element(all.begin(), all.begin() + static_cast<std::ptrdiff_t>(candidates),
                                            [](const Sinr& a, const Sinr& b) { return a.sinr < b.sinr; });
      std::vector<double> others;
      for (const Sinr& other : all)
        if (other.station != serving->station) others.push_back(10 * std::log10(std::max(1e-20, other.sinr)));
      std::sort(others.rbegin(), others.rend());
      INFO("point " << point << " height index " << i);
      REQUIRE(column[i].serving_cell == static_cast<std::int32_t>(serving->station));
      REQUIRE(column[i].qos == Approx(std::log2(1 + serving->sinr)).epsilon(1e-9));
      REQUIRE(column[i].serving_sinr_db == Approx(10 * std::log10(serving->sinr)).margin(1e-8));
      REQUIRE(column[i].neighbour_count == neighbours);
      for (std::size_t j = 0; j < neighbours; ++j)
        REQUIRE(column[i].neighbour_sinr_db.at(j) == Approx(others[j]).margin(1e-6));
    }
  }
}

}  // namespace

TEST_CASE("the fast map agrees with a direct implementation of the radio model") {
  check_against_plain({{"bs_density_per_km2", 5}});
  check_against_plain({{"bs_density_per_km2", 1}});
  check_against_plain({{"bs_density_per_km2", 5}, {"neighbours", 5}});
}

TEST_CASE("the fast map agrees with the direct implementation for all presets and switches") {
  check_against_plain({{"preset", "paper-text"}});
  check_against_plain({{"preset", "geometric"}, {"bs_density_per_km2", 5}});
  check_against_plain({{"bs_antenna", "sector"}, {"bs_density_per_km2", 5}});
  check_against_plain({{"serving_selection", "best-of-all"}});
  check_against_plain({{"uav_antenna", "omnidirectional"}, {"path_distance", "horizontal"}, {"fading", "none"}});
}

TEST_CASE("a city with more base stations than fading can number is refused") {
  const Parameters world = radio::resolve_generated_world(json::object(), "world");
  world::City city = world::generate_city(world, seed, trial);
  city.base_stations.resize(limits::base_stations + 1);
  CHECK_THROWS_WITH(radio::make_generated_map(world, city, seed, trial),
                    Catch::Contains("65537 base stations") && Catch::Contains("at most 65536"));
}

TEST_CASE("columns do not depend on the order of calls, nor on the table's resolution") {
  const Parameters world = radio::resolve_generated_world(json::object(), "world");
  const world::City city = world::generate_city(world, seed, trial);
  const auto forwards = radio::make_generated_map(world, city, seed, trial);
  const auto backwards = radio::make_generated_map(world, city, seed, trial);
  forwards->prepare();
  for (std::uint32_t point = 101; point-- > 0;) {
    const world::Position position = backwards->advance(point, {}, -1);
    const auto& a = forwards->column(point, position);
    const auto& b = backwards->column(point, position);
    REQUIRE(a.size() == 201);
    for (std::size_t i = 0; i < a.size(); ++i) {
      REQUIRE(a[i].qos == b[i].qos);
      REQUIRE(a[i].serving_cell == b[i].serving_cell);
      REQUIRE(a[i].neighbour_sinr_db == b[i].neighbour_sinr_db);
    }
  }
  CHECK(&forwards->column(5, forwards->advance(5, {}, -1)) == &forwards->column(5, forwards->advance(5, {}, -1)));
}

TEST_CASE("with the serving route rule a column depends on the lateral position, not only on the route point") {
  const Parameters world = radio::resolve_generated_world({{"route", "serving"}}, "world");
  const auto map = radio::make_generated_map(world, world::generate_city(world, seed, trial), seed, trial);
  CHECK_FALSE(map->fixed_route());
  map->prepare();  // must do nothing
  const auto& line = map->column(7, {map->start().x_m + 70.0, 0.0});
  const auto& beside = map->column(7, {map->start().x_m + 70.0, 10.0});
  CHECK(&line != &beside);
  CHECK(line[100].qos != beside[100].qos);
  CHECK(&line == &map->column(7, {map->start().x_m + 70.0, 0.0}));
}
