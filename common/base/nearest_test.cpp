#include "common/base/nearest.hpp"

#include <catch2/catch.hpp>
#include <vector>

TEST_CASE("a misspelt key finds the nearest valid one, nonsense finds none") {
  const std::vector<std::string> keys{"trials", "world", "agents", "bs_density_per_km2"};
  CHECK(aloft::nearest("trails", keys) == "trials");
  CHECK(aloft::nearest("bs_density", keys).empty());
  CHECK(aloft::nearest("bs_densty_per_km2", keys) == "bs_density_per_km2");
  CHECK(aloft::nearest("zzzzzz", keys).empty());
  CHECK(aloft::did_you_mean("word", keys) == " Did you mean 'world'?");
}
