#include "common/agents/route_ahead.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <span>
#include <string>
#include <vector>

#include "common/base/error.hpp"

using namespace aloft;
using namespace aloft::agents;

namespace {

/// The places of `count` steps from step + 1 on; step j is at x = j.
SiteMap told(std::uint32_t step, std::uint32_t count) {
  SiteMap map;
  map.step = step;
  for (std::uint32_t i = 1; i <= count; ++i) map.route.push_back({static_cast<double>(step + i), 0.0});
  return map;
}

}  // namespace

TEST_CASE("a route is told at once or in parts, and repeated without harm") {
  RouteAhead route;
  CHECK(route.hear(told(0, 3)) == 3);
  CHECK(route.hear(told(0, 3)) == 0);
  CHECK(route.hear(told(1, 3)) == 1);
  CHECK(route.first_step() == 1);
  CHECK(route.steps() == 4);
  for (std::uint32_t step = 1; step <= 4; ++step) CHECK(route.place(step)->x_m == step);
  CHECK_FALSE(route.place(0).has_value());
  CHECK_FALSE(route.place(5).has_value());
}

TEST_CASE("a route forgets what is past, and starts anew after a gap") {
  RouteAhead route;
  route.hear(told(0, 3));
  route.forget_before(3);
  CHECK_FALSE(route.place(2).has_value());
  CHECK(route.place(3)->x_m == 3);
  CHECK(route.hear(told(1, 3)) == 0);  // late, and its step 4 is told again with the next report
  CHECK(route.hear(told(2, 2)) == 1);
  CHECK(route.hear(told(7, 2)) == 2);
  CHECK(route.first_step() == 8);
  CHECK(route.steps() == 2);
  CHECK(route.place(9)->x_m == 9);
}

TEST_CASE("a route is saved and restored; one that does not fit the flight is refused") {
  const Parameters none{std::vector<ParameterSpec>{}};
  RouteAhead route;
  route.hear(told(4, 3));
  StateWriter saved("x", none);
  route.save(saved);
  RouteAhead other;
  other.restore(StateReader(saved.bytes(), "x", none), 7);
  CHECK(other.first_step() == 5);
  CHECK(other.places().size() == 3);
  CHECK(other.place(7)->x_m == 7);
  CHECK_THROWS_AS(other.restore(StateReader(saved.bytes(), "x", none), 6), IntegrityError);
  const auto refused = [&](std::uint64_t first_step, const std::vector<double>& metres) {
    StateWriter writer("x", none);
    writer.put_integer("route.first_step", first_step);
    writer.put("route", std::span(metres));
    CHECK_THROWS_AS(other.restore(StateReader(writer.bytes(), "x", none), 7), IntegrityError);
  };
  refused(0, {0, 0});
  refused(9, {0, 0});
  refused(1, {0, 0, 0});
  refused(1, {0, NAN});
}
