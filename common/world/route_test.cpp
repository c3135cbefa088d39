#include "common/world/route.hpp"

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

using namespace aloft;

namespace {

world::City city_with(std::vector<world::Position> stations) {
  world::City city;
  city.window_m = 3000.0;
  city.base_stations = std::move(stations);
  return city;
}

Parameters parameters(const char* rule) {
  return Parameters(world::route_parameters(), {{"route", rule}}, "world");
}

}  // namespace

TEST_CASE("the nearest rule takes the clamped y of the base station nearest to the line") {
  const world::City city = city_with({{-505.0, 4.0}, {0.0, -300.0}, {400.0, 250.0}});
  const world::Route route(parameters("nearest"), city);
  CHECK(route.fixed());
  CHECK(route.steps() == 100);
  CHECK(route.start().x_m == -505.0);
  CHECK(route.start().y_m == 4.0);
  const world::Position middle = route.advance(50, {123.0, 45.0}, 2);  // independent of where the UAV was
  CHECK(middle.x_m == -5.0);
  CHECK(middle.y_m == -10.0);
  const world::Position end = route.advance(100, middle, -1);
  CHECK(end.x_m == 495.0);
  CHECK(end.y_m == 10.0);
}

TEST_CASE("the serving rule goes towards the serving base station and stays near the line") {
  const world::City city = city_with({{-505.0, 4.0}, {0.0, -300.0}});
  const world::Route route(parameters("serving"), city);
  CHECK_FALSE(route.fixed());
  CHECK(route.start().y_m == 0.0);
  CHECK(route.advance(1, route.start(), 0).y_m == 4.0);
  CHECK(route.advance(1, route.start(), 0).x_m == -495.0);
  CHECK(route.advance(2, {-495.0, 4.0}, 1).y_m == -6.0);    // by at most 10 m
  CHECK(route.advance(3, {-485.0, -6.0}, 1).y_m == -10.0);  // at most 10 m off
  CHECK(route.advance(3, {-485.0, -6.0}, -1).y_m == -6.0);
}
