#include "common/learn/replay.hpp"

#include <array>
#include <catch2/catch.hpp>
#include <set>

using aloft::learn::ReplayMemory;
using aloft::learn::Transition;

TEST_CASE("the oldest transition is forgotten first") {
  ReplayMemory memory(3);
  for (std::uint32_t i = 0; i < 5; ++i) memory.add({{}, i, 0.0F, {}, false});
  std::set<std::uint32_t> kept;
  for (const Transition& t : memory.slots()) kept.insert(t.action);
  CHECK(kept == std::set<std::uint32_t>{2, 3, 4});
  CHECK(memory.next_slot() == 2);
}

TEST_CASE("a sample has no transition twice, and all are equally likely") {
  ReplayMemory memory(20);
  for (std::uint32_t i = 0; i < 20; ++i) memory.add({{}, i, 0.0F, {}, false});
  aloft::RandomStream random(1, 0, "replay");
  std::array<int, 20> counts{};
  for (int round = 0; round < 5000; ++round) {
    std::set<std::uint32_t> different;
    for (const Transition* t : memory.sample(16, random)) {
      different.insert(t->action);
      ++counts.at(t->action);
    }
    REQUIRE(different.size() == 16);
  }
  for (const int count : counts) CHECK(count == Approx(4000).margin(4 * 28.3));  // sd sqrt(5000 * 0.8 * 0.2)
}

TEST_CASE("a larger sample than the memory is a bug") {
  const ReplayMemory memory(20);
  aloft::RandomStream random(1, 0, "replay");
  CHECK_THROWS_AS(memory.sample(1, random), std::logic_error);
}
