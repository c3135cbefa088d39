#include "common/base/cores.hpp"

#include <sched.h>

#include <algorithm>
#include <catch2/catch.hpp>
#include <map>

TEST_CASE("cores that this process may not use do not count", "[cores]") {
  cpu_set_t before;
  REQUIRE(sched_getaffinity(0, sizeof before, &before) == 0);
  CHECK(aloft::usable_cores() == static_cast<unsigned>(CPU_COUNT(&before)));
  int core = 0;
  while (!CPU_ISSET(core, &before)) ++core;
  cpu_set_t one;
  CPU_ZERO(&one);
  CPU_SET(core, &one);
  REQUIRE(sched_setaffinity(0, sizeof one, &one) == 0);
  CHECK(aloft::usable_cores() == 1);
  REQUIRE(sched_setaffinity(0, sizeof before, &before) == 0);
}

TEST_CASE("shares of the cores are equal, cover all, and are given back", "[cores]") {
  cpu_set_t before;
  REQUIRE(sched_getaffinity(0, sizeof before, &before) == 0);
  const auto cores = static_cast<unsigned>(CPU_COUNT(&before));
  for (const unsigned shares : {1U, 2U, 3U, cores, 64U}) {
    std::map<int, unsigned> taken;  // by core
    for (unsigned part = 0; part < shares; ++part) {
      const aloft::OnCores pinned({part, shares});
      CHECK(aloft::usable_cores() >= std::max(1U, cores / shares));
      CHECK(aloft::usable_cores() <= cores / shares + 1);
      cpu_set_t ours;
      REQUIRE(sched_getaffinity(0, sizeof ours, &ours) == 0);
      for (int core = 0; core < CPU_SETSIZE; ++core)
        if (CPU_ISSET(core, &ours)) ++taken[core];
    }
    CHECK(taken.size() == cores);
    for (const auto& [core, times] : taken) {
      CHECK(CPU_ISSET(core, &before));
      CHECK(times <= shares / cores + 1);
    }
    CHECK(aloft::usable_cores() == cores);
  }
}
