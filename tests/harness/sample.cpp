// Test cases of every kind, for harness_test.cpp to run.
#include <catch2/catch.hpp>

#include "tests/skip.hpp"

TEST_CASE("passes", "[passes]") {
  CHECK(true);
}

TEST_CASE("cannot run here", "[skips]") {
  return aloft::test::skip("there is no second moon");
}

TEST_CASE("fails as often as the exit code for skipped tests is high", "[fails]") {
  for (int i = 0; i < 77; ++i) CHECK(i < 0);
}
