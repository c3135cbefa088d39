#include <catch2/catch.hpp>

#include "tests/statistics/agent_means.hpp"

using aloft::statistics::check_expected_means;

TEST_CASE("agents fly as well as expected, few trials") {
  check_expected_means({1, 200}, 40);
  check_expected_means({2.5, 200}, 40);
  check_expected_means({5, 200}, 40);
}
