// What the guard keeps from the middleware although nothing is wrong with it.
#include "common/bus/guard/datagram_guard.hpp"

#include <catch2/catch.hpp>
#include <vector>

#include "common/bus/guard/testing/datagrams.hpp"

namespace aloft::bus::guard {

using namespace testing;

TEST_CASE("the middleware gets no farewell, except through a discovery server; it is told and no refusal") {
  for (const bool little : {false, true})
    for (const bool relayed : {false, true}) {
      std::vector<Prefix> left;
      DatagramGuard guard(relayed, [&](const Prefix& participant) { left.push_back(participant); });
      const Bytes come = datagram({announcement(little, prefix_of(1), 20, [](Out& /*out*/) {})});
      const Bytes go = datagram({farewell(little, prefix_of(1))});
      CHECK(guard.admit(come, loopback));
      CHECK(left.empty());
      CHECK(guard.admit(go, loopback) == relayed);
      CHECK(left == (relayed ? std::vector<Prefix>{} : std::vector{prefix_of(1)}));
      CHECK(guard.refused() == RefusalCounts{});
    }
}

}  // namespace aloft::bus::guard
