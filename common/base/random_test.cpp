#include "common/base/random.hpp"

#include <Random123/philox.h>

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <cstddef>
#include <vector>

using aloft::RandomStream;

TEST_CASE("the generator is Philox4x32-10: the published known-answer vector") {
  // Random123's kat_vectors: counter and key all ones.
  const r123::Philox4x32 philox;
  const auto words = philox({{0xffffffffU, 0xffffffffU, 0xffffffffU, 0xffffffffU}}, {{0xffffffffU, 0xffffffffU}});
  CHECK(words[0] == 0x408f276dU);
  CHECK(words[1] == 0x41c83b0eU);
  CHECK(words[2] == 0xa20bc7c6U);
  CHECK(words[3] == 0x6d5451fdU);
}

TEST_CASE("streams are a pure function of seed, trial and name") {
  RandomStream a(7, 3, "city");
  RandomStream b(7, 3, "city");
  std::vector<std::uint32_t> first(100);
  for (std::uint32_t& word : first) word = a.next_u32();
  for (const std::uint32_t word : first) CHECK(b.next_u32() == word);
  CHECK(RandomStream(8, 3, "city").next_u32() != first[0]);
  CHECK(RandomStream(7, 4, "city").next_u32() != first[0]);
  CHECK(RandomStream(7, 3, "fading").next_u32() != first[0]);
}

TEST_CASE("many blocks at once equal the single blocks") {
  const RandomStream stream(7, 3, "fading");
  for (const std::uint32_t count : {0U, 1U, 3U, 16U, 53U}) {  // with whole vectors and without
    std::vector<std::uint32_t> b;
    std::vector<std::uint32_t> c;
    for (std::uint32_t i = 0; i < count; ++i) {
      b.push_back(i * 65'537U);
      c.push_back(100U - i);
    }
    std::vector<std::uint32_t> words(std::size_t{4} * count);
    stream.blocks(9, b, c, words.data());
    for (std::size_t i = 0; i < count; ++i) {
      const auto expected = stream.block(9, b[i], c[i]);
      CHECK(std::equal(expected.begin(), expected.end(), words.begin() + static_cast<std::ptrdiff_t>(4 * i)));
    }
  }
}

TEST_CASE("a stream resumes at the position where it was left") {
  RandomStream a(1, 1, "x");
  for (int i = 0; i < 13; ++i) a.next_u32();
  RandomStream b(1, 1, "x");
  b.seek(a.position());
  for (int i = 0; i < 9; ++i) CHECK(a.next_u32() == b.next_u32());
}

TEST_CASE("many uniform numbers at once equal the single ones, wherever the stream is") {
  for (const std::uint64_t position :
       {0ULL, 1ULL, 2ULL, 3ULL, 4ULL, (1ULL << 34U) - 6}) {  // the last: the counter's high word
    for (const std::size_t count : {0U, 1U, 2U, 3U, 128U, 131U, 1000U}) {
      RandomStream single(7, 3, "x");
      RandomStream together(7, 3, "x");
      single.seek(position);
      together.seek(position);
      std::vector<double> values(count);
      together.uniforms(values);
      for (const double value : values) REQUIRE(value == single.uniform());
      CHECK(together.position() == single.position());
      CHECK(together.next_u32() == single.next_u32());
    }
  }
}

TEST_CASE("distributions have their textbook mean and variance") {
  constexpr int n = 200'000;
  RandomStream stream(42, 0, "moments");
  const auto moments = [&](auto draw) {
    double sum = 0;
    double squares = 0;
    for (int i = 0; i < n; ++i) {
      const double x = draw();
      sum += x;
      squares += x * x;
    }
    const double mean = sum / n;
    return std::pair(mean, squares / n - mean * mean);
  };
  const auto check = [&](auto draw, double mean, double variance) {
    const auto [m, v] = moments(draw);
    CHECK(m == Approx(mean).margin(5 * std::sqrt(variance / n)));
    CHECK(v == Approx(variance).epsilon(0.05));
  };
  check([&] { return stream.uniform(); }, 0.5, 1.0 / 12);
  check([&] { return stream.normal(); }, 0.0, 1.0);
  check([&] { return double(stream.poisson(20)); }, 20.0, 20.0);
  check([&] { return double(stream.uniform_index(6)); }, 2.5, 35.0 / 12);
}

TEST_CASE("a Poisson mean above the largest piece is still exact") {
  RandomStream stream(5, 0, "poisson");
  double sum = 0;
  for (int i = 0; i < 2000; ++i) sum += stream.poisson(2700);
  CHECK(sum / 2000 == Approx(2700).margin(5 * std::sqrt(2700.0 / 2000)));
}
