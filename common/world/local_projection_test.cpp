#include "common/world/local_projection.hpp"

#include <array>
#include <catch2/catch.hpp>
#include <cmath>

using namespace aloft::world;

TEST_CASE("a degree is as long as in tables of WGS 84") {
  struct Length {
    double latitude_deg;
    double east_km;
    double north_km;
  };
  constexpr std::array<Length, 3> table{{{0, 111.320, 110.574}, {45, 78.847, 111.132}, {60, 55.800, 111.412}}};
  for (const Length& length : table) {
    INFO(length.latitude_deg);
    for (const double sign : {1.0, -1.0}) {
      const LocalProjection projection({sign * length.latitude_deg, -6.0});
      const Position east = projection({sign * length.latitude_deg, -5.99});
      CHECK(east.x_m == Approx(10.0 * length.east_km).margin(0.01));
      CHECK(east.y_m == 0.0);
      const Position north = projection({sign * length.latitude_deg + 0.01, -6.0});
      CHECK(north.x_m == 0.0);
      CHECK(north.y_m == Approx(10.0 * length.north_km).margin(0.01));
    }
  }
}

TEST_CASE("ten kilometres are right to 0.1 %, whatever their direction") {
  // From 53.34 N 6.24 W by Vincenty's formula on WGS 84: 10 km to the north, north-east, east and south-west.
  const LocalProjection projection({53.34, -6.24});
  const auto distance_m = [&](GeoPosition place) {
    const Position position = projection(place);
    return std::sqrt(position.x_m * position.x_m + position.y_m * position.y_m);
  };
  CHECK(distance_m({53.4298525, -6.2400000}) == Approx(10'000).epsilon(1e-3));
  CHECK(distance_m({53.4034882, -6.1336836}) == Approx(10'000).epsilon(1e-3));
  CHECK(distance_m({53.3399056, -6.0898695}) == Approx(10'000).epsilon(1e-3));
  CHECK(distance_m({53.2764167, -6.3460009}) == Approx(10'000).epsilon(1e-3));
}

TEST_CASE("the place at a position, also across the meridian of 180 degrees") {
  // 10 km to the north and to the east by Vincenty's formula, as above: 0.1 % are 10 m, or 0.0001 degrees.
  const LocalProjection projection({53.34, -6.24});
  CHECK(projection.inverse({0.0, 10'000.0}).latitude_deg == Approx(53.4298525).margin(1e-4));
  CHECK(projection.inverse({0.0, 10'000.0}).longitude_deg == -6.24);
  CHECK(projection.inverse({10'000.0, 0.0}).longitude_deg == Approx(-6.0898695).margin(1.5e-4));
  CHECK(LocalProjection({0.0, 179.999}).inverse({222.64, 0.0}).longitude_deg == Approx(-179.999).margin(1e-6));
}

TEST_CASE("the mean of places, also across the meridian of 180 degrees") {
  const auto near = [](GeoPosition mean, GeoPosition expected) {
    CHECK(mean.latitude_deg == Approx(expected.latitude_deg));
    CHECK(std::remainder(mean.longitude_deg - expected.longitude_deg, 360.0) == Approx(0.0).margin(1e-9));
  };
  near(mean_position(std::array<GeoPosition, 1>{{{53.0, -6.0}}}), {53.0, -6.0});
  near(mean_position(std::array<GeoPosition, 3>{{{53.0, -6.0}, {53.3, -6.3}, {53.3, -6.6}}}), {53.2, -6.3});
  near(mean_position(std::array<GeoPosition, 2>{{{-10.0, 179.0}, {-12.0, -178.0}}}), {-11.0, -179.5});
  CHECK(LocalProjection({0.0, 179.999})({0.0, -179.999}).x_m == Approx(222.64).margin(0.01));
}
