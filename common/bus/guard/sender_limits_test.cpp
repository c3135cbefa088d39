// How much senders may claim, and how the limits give way with time.
#include "common/bus/guard/sender_limits.hpp"

#include <catch2/catch.hpp>

#include "common/bus/guard/testing/datagrams.hpp"

namespace aloft::bus::guard {
namespace {

using namespace std::chrono_literals;
using testing::prefix_of;
using Clock = SenderLimits::Clock;

constexpr std::uint32_t here = testing::loopback;
constexpr std::uint32_t elsewhere = 0x0a000007;

Claims announced(std::uint32_t number, std::uint32_t lease_s = 2) {
  Claims claims;
  claims.sender = prefix_of(number);
  claims.announcements.push_back({.participant = claims.sender, .lease_s = lease_s});
  return claims;
}

Claims leaving(std::uint32_t number) {
  Claims claims = announced(number);
  claims.announcements.front().leaving = true;
  return claims;
}

Claims from(std::uint32_t number) {
  Claims claims;
  claims.sender = prefix_of(number);
  return claims;
}

Claims fragment(std::int64_t sequence_number, std::uint32_t arrived = 1, std::uint32_t sample_bytes = 16U << 20U) {
  Claims claims = from(1);
  claims.fragments.push_back({.writer = testing::of_a_user,
                              .sequence_number = sequence_number,
                              .sample_bytes = sample_bytes,
                              .total = 300,
                              .arrived = arrived});
  return claims;
}

}  // namespace

TEST_CASE("24 workers of 5 processes that start at once on one host are admitted, and one more of each") {
  SenderLimits limits(false);
  const Clock::time_point now{};
  for (int repeat = 0; repeat < 5; ++repeat)
    for (std::uint32_t i = 0; i < 150; ++i) REQUIRE(limits.admit(here, announced(i), now) == Refusal::none);
  CHECK(limits.participants() == 150);
}

TEST_CASE("an address announces no more participants than a host can have, until some fall silent") {
  SenderLimits limits(false);
  Clock::time_point now{};
  constexpr std::uint32_t most = SenderLimits::participants_per_address;
  for (std::uint32_t i = 0; i < most; ++i) REQUIRE(limits.admit(here, announced(i), now) == Refusal::none);
  CHECK(limits.admit(here, announced(most), now) == Refusal::participants);
  CHECK(limits.admit(here, announced(3), now) == Refusal::none);
  CHECK(limits.admit(elsewhere, announced(most), now) == Refusal::none);
  REQUIRE(limits.admit(here, leaving(5), now) == Refusal::none);  // the middleware does not hear of it
  CHECK(limits.admit(here, announced(most + 1), now) == Refusal::participants);
  now += 1500ms;
  REQUIRE(limits.admit(here, from(3), now) == Refusal::none);
  now += 1s;
  CHECK(limits.admit(here, announced(most + 1), now) == Refusal::none);
  CHECK(limits.participants() == 2);  // the one that was heard is still known
}

TEST_CASE("100,000 forged participants from as many addresses are not all remembered") {
  SenderLimits limits(true);
  const Clock::time_point now{};
  for (std::uint32_t i = 0; i < 100'000; ++i) (void)limits.admit(i + 1, announced(i), now);
  CHECK(limits.participants() == SenderLimits::max_participants);
}

TEST_CASE("a discovery server announces all participants from its address, and those that leave are forgotten") {
  SenderLimits limits(true);
  for (std::uint32_t i = 0; i < 1000; ++i) REQUIRE(limits.admit(here, announced(i), {}) == Refusal::none);
  REQUIRE(limits.admit(here, leaving(5), {}) == Refusal::none);
  CHECK(limits.participants() == 999);
}

TEST_CASE("unannounced senders are limited by address, others are not") {
  SenderLimits limits(false);
  Clock::time_point now{};
  REQUIRE(limits.admit(here, announced(1), now) == Refusal::none);
  int admitted = 0;
  for (std::uint32_t i = 0; i < 10'000; ++i)
    admitted += limits.admit(here, from(1000 + i), now) == Refusal::none ? 1 : 0;
  CHECK(admitted == 4096);
  CHECK(limits.admit(here, from(2), now) == Refusal::rate);
  CHECK(limits.admit(elsewhere, from(2), now) == Refusal::none);
  for (int i = 0; i < 10'000; ++i) REQUIRE(limits.admit(here, from(1), now) == Refusal::none);
  now += 500ms;
  admitted = 0;
  for (int i = 0; i < 10'000; ++i) admitted += limits.admit(here, from(2), now) == Refusal::none ? 1 : 0;
  CHECK(admitted == 512);
  CHECK(limits.admit(here, announced(2), now) == Refusal::none);
  CHECK(limits.admit(here, from(2), now) == Refusal::none);
}

TEST_CASE("a sender begins no more samples than 256 MB, until they are complete or given up") {
  SenderLimits limits(false);
  Clock::time_point now{};
  REQUIRE(limits.admit(here, announced(1, 20), now) == Refusal::none);
  for (int i = 1; i <= 16; ++i) REQUIRE(limits.admit(here, fragment(i), now) == Refusal::none);
  CHECK(limits.admit(here, fragment(17), now) == Refusal::pending);
  CHECK(limits.admit(here, fragment(5, 200), now) == Refusal::none);
  CHECK(limits.admit(here, fragment(17), now) == Refusal::pending);
  CHECK(limits.admit(here, fragment(5, 99), now) == Refusal::none);
  CHECK(limits.admit(here, fragment(17), now) == Refusal::none);
  CHECK(limits.admit(here, fragment(18), now) == Refusal::pending);
  now += 2s;
  CHECK(limits.admit(here, fragment(18), now) == Refusal::none);
}

TEST_CASE("one sample after the other is never too much") {
  SenderLimits limits(false);
  REQUIRE(limits.admit(here, announced(1, 20), {}) == Refusal::none);
  for (int i = 1; i <= 1000; ++i)
    for (int part = 0; part < 300; ++part) REQUIRE(limits.admit(here, fragment(i), {}) == Refusal::none);
}

TEST_CASE("a sender declares no more samples missing than one wide gap in 10 s") {
  SenderLimits limits(false);
  Clock::time_point now = Clock::time_point{} + 1h;
  REQUIRE(limits.admit(here, announced(1, 100), now) == Refusal::none);
  Claims wide = from(1);
  wide.missing = widest_gap;
  CHECK(limits.admit(here, wide, now) == Refusal::none);
  CHECK(limits.admit(here, wide, now) == Refusal::gap);
  now += 11s;
  CHECK(limits.admit(here, wide, now) == Refusal::none);
}

}  // namespace aloft::bus::guard
