#include "bench/step_traffic.hpp"

#include <catch2/catch.hpp>

#include "bench/cache_model.hpp"

using namespace aloft;

TEST_CASE("a model of a cache keeps the lines that were used last") {
  bench::CacheModel cache(2, 4);
  CHECK_FALSE(cache.use(0));
  CHECK_FALSE(cache.use(1));
  CHECK(cache.use(0));
  CHECK_FALSE(cache.use(2));  // instead of 1
  CHECK(cache.use(0));
  CHECK_FALSE(cache.use(1));  // instead of 2
  CHECK_FALSE(cache.use(2));  // instead of 0
  CHECK_FALSE(cache.use(0));
}

TEST_CASE("a gradient step touches weights forwards, and weights and moments backwards") {
  // 15 inputs and the constant one: a line for each of 2 outputs. Forwards 2 lines, backwards 3 for each output; a
  // first layer has no deltas. None of them follows itself, so a cache of one line has none.
  const learn::NetworkShape one_layer{{{15, 2, learn::Activation::linear}}};
  const std::vector<bench::CacheLevel> tiny{{"L1", 64, 1.0}, {"memory", 0, 1.0}};
  const bench::StepTraffic all = bench::step_traffic(one_layer, learn::Path::avx512, tiny);
  CHECK(all.array_bytes == 6 * 64);
  CHECK(all.bytes_from == std::vector<std::size_t>{0, 8 * 64});
}

TEST_CASE("what fits into a cache does not come from beyond it") {
  const learn::NetworkShape shape = learn::dqn_shape(38, 64);
  for (const learn::Path path : {learn::Path::avx2, learn::Path::avx512}) {
    const std::size_t bytes = bench::step_traffic(shape, path, {{"memory", 0, 1.0}}).array_bytes;
    const auto fits = bench::step_traffic(shape, path, {{"L2", bytes, 1.0}, {"memory", 0, 1.0}});
    CHECK(fits.bytes_from[1] == 0);
    const auto half = bench::step_traffic(shape, path, {{"L2", bytes / 2, 1.0}, {"memory", 0, 1.0}});
    CHECK(half.bytes_from[1] > bytes / 2);
  }
}
