#include "common/world/site_map.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <nlohmann/json.hpp>

using namespace aloft;
using nlohmann::json;

namespace {

std::vector<world::Position> stations() {
  std::vector<world::Position> all;
  for (int k = 0; k < 2000; ++k) all.push_back({10.0 * k, -5.0 * k});
  return all;
}

world::SiteMap map_with(const json& given, std::uint32_t trial = 3) {
  return world::draw_site_map(Parameters(world::site_map_parameters(), given, "world"), stations(), {}, 42, trial);
}

}  // namespace

TEST_CASE("without errors the site map is exact") {
  const world::SiteMap map = map_with(json::object());
  REQUIRE(map.sites.size() == 2000);
  CHECK(map.position_error_m == 0.0);
  CHECK(map.route_points == 0);
  for (std::size_t k = 0; k < map.sites.size(); ++k) {
    CHECK(map.sites[k].cell == static_cast<int>(k));
    CHECK(map.sites[k].position.x_m == stations()[k].x_m);
    CHECK(map.sites[k].position.y_m == stations()[k].y_m);
  }
}

TEST_CASE("errors are normal with the stated deviation on each axis, and grow with it station by station") {
  const world::SiteMap small = map_with({{"site_map_error_m", 10}});
  const world::SiteMap large = map_with({{"site_map_error_m", 50}, {"site_map_route_points", 7}});
  REQUIRE(small.sites.size() == 2000);
  CHECK(large.position_error_m == 50.0);
  CHECK(large.route_points == 7);
  double sum2_x = 0.0;
  double sum2_y = 0.0;
  double sum_xy = 0.0;
  for (std::size_t k = 0; k < 2000; ++k) {
    const double x_m = small.sites[k].position.x_m - stations()[k].x_m;
    const double y_m = small.sites[k].position.y_m - stations()[k].y_m;
    CHECK(large.sites[k].position.x_m - stations()[k].x_m == Approx(5 * x_m).margin(1e-9));
    sum2_x += x_m * x_m;
    sum2_y += y_m * y_m;
    sum_xy += x_m * y_m;
  }
  // Standard errors of the deviations: 10 / sqrt(2 * 2000) = 0.16; of the correlation: 1 / sqrt(2000) = 0.022.
  CHECK(std::sqrt(sum2_x / 2000) == Approx(10.0).margin(0.7));
  CHECK(std::sqrt(sum2_y / 2000) == Approx(10.0).margin(0.7));
  CHECK(std::fabs(sum_xy / 2000 / 100) < 0.1);
}

TEST_CASE("missing sites: about the stated share, the others as without, in another trial others") {
  const world::SiteMap whole = map_with({{"site_map_error_m", 10}});
  const world::SiteMap part = map_with({{"site_map_error_m", 10}, {"site_map_missing", 0.1}});
  CHECK(part.missing == 0.1);
  CHECK(std::fabs(static_cast<double>(part.sites.size()) - 1800.0) < 60.0);  // standard deviation 13.4
  for (const world::Site& site : part.sites) {
    CHECK(site.position.x_m == whole.sites.at(static_cast<std::size_t>(site.cell)).position.x_m);
    CHECK(site.position.y_m == whole.sites.at(static_cast<std::size_t>(site.cell)).position.y_m);
  }
  const world::SiteMap other = map_with({{"site_map_error_m", 10}, {"site_map_missing", 0.1}}, 4);
  CHECK(other.sites.size() != part.sites.size());
}
