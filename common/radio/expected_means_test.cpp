#include "common/radio/testing/expected_means.hpp"

#include <catch2/catch.hpp>

using namespace aloft::radio;

TEST_CASE("a few trials give the reference means of the published preset") {
  for (const ReferenceCondition& condition : reference_conditions) check_means(condition, 40);
}
