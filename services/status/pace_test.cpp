#include "services/status/pace.hpp"

#include <catch2/catch.hpp>

using namespace std::chrono_literals;
using aloft::status::Pace;

namespace {

constexpr Pace::Clock::time_point start{1000s};

}  // namespace

TEST_CASE("a run is blocked when nothing is stored for much longer than usual", "[status]") {
  Pace pace;
  CHECK_FALSE(pace.blocked_for(start));
  for (int i = 0; i <= 20; ++i) pace.update(static_cast<std::uint64_t>(i), false, start + i * 2s);
  CHECK_FALSE(pace.blocked_for(start + 60s));  // 20 s since the last flight, 2 s are usual
  CHECK(pace.blocked_for(start + 61s) == 21s);
  pace.update(20, false, start + 90s);  // nothing new is stored
  CHECK(pace.blocked_for(start + 90s) == 50s);
  pace.update(21, false, start + 91s);
  CHECK_FALSE(pace.blocked_for(start + 92s));
}

TEST_CASE("a run that says it waits is blocked sooner, but not while flights still come", "[status]") {
  Pace pace;
  for (int i = 0; i <= 20; ++i) pace.update(static_cast<std::uint64_t>(i), true, start + i * 100ms);
  CHECK_FALSE(pace.blocked_for(start + 4s));
  CHECK(pace.blocked_for(start + 4100ms) == 2100ms);
  Pace quick;
  for (int i = 0; i <= 20; ++i) quick.update(static_cast<std::uint64_t>(i), false, start + i * 100ms);
  CHECK_FALSE(quick.blocked_for(start + 7s));
  CHECK(quick.blocked_for(start + 7100ms));
}
