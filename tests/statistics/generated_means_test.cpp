#include <catch2/catch.hpp>

#include "common/radio/testing/expected_means.hpp"

using namespace aloft::radio;

TEST_CASE("1,000 trials give the reference means of the published preset") {
  for (const ReferenceCondition& condition : reference_conditions) check_means(condition, 1000);
}
