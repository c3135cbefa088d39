#include "services/coordinator/lease_ledger.hpp"

#include <algorithm>
#include <catch2/catch.hpp>
#include <set>
#include <stdexcept>

using namespace aloft::coordinator;
using namespace std::chrono_literals;

namespace {

const Clock::time_point start{};

HeartbeatResult beat(LeaseLedger& ledger, std::string_view worker, Clock::time_point now,
                     const std::vector<std::uint64_t>& leases = {}, std::uint32_t capacity = 1,
                     std::uint64_t incarnation = 7) {
  return ledger.heartbeat({worker, incarnation, capacity, leases}, now);
}

bool nothing_to_grant(LeaseLedger& ledger, Clock::time_point now = start) {
  Lease lease;
  return !ledger.grant(now, lease);
}

Lease must_grant(LeaseLedger& ledger, Clock::time_point now = start) {
  Lease lease;
  REQUIRE(ledger.grant(now, lease));
  return lease;
}

std::vector<std::uint32_t> trials_in_order(LeaseLedger& ledger, std::uint32_t agents) {
  std::vector<std::uint32_t> order;
  beat(ledger, "w0", start);
  for (Lease lease; ledger.grant(start, lease);) {
    order.push_back(lease.condition * 1000 + lease.trial);
    for (std::uint32_t agent = 0; agent < agents; ++agent) ledger.flight_stored(lease.condition, lease.trial, agent);
  }
  return order;
}

}  // namespace

TEST_CASE("trials are leased condition by condition, each worker up to its capacity", "[ledger]") {
  LeaseLedger ledger({.conditions = 2, .trials = 2, .agents = 1});
  beat(ledger, "w0", start, {}, 2);
  beat(ledger, "w1", start, {}, 1);
  std::vector<std::tuple<std::string, std::uint32_t, std::uint32_t>> granted;
  for (Lease lease; ledger.grant(start, lease);) granted.emplace_back(lease.worker, lease.condition, lease.trial);
  REQUIRE(granted ==
          std::vector<std::tuple<std::string, std::uint32_t, std::uint32_t>>{{"w0", 0, 0}, {"w1", 0, 1}, {"w0", 1, 0}});
  CHECK(ledger.count(TrialState::leased) == 3);
  CHECK(ledger.count(TrialState::pending) == 1);
  CHECK(ledger.flight_stored(0, 1, 0));
  CHECK(must_grant(ledger).worker == "w1");
  CHECK(ledger.count(TrialState::done) == 1);
}

TEST_CASE("a worker that leaves is gone at once; its trials return to the queue, and are not held against",
          "[ledger]") {
  LeaseLedger ledger({.trials = 1, .max_losses = 1});
  CHECK_FALSE(beat(ledger, "stranger", start, {}, 0).left);
  CHECK(ledger.workers_alive() == 0);
  beat(ledger, "w0", start);
  const Lease lease = must_grant(ledger);
  const HeartbeatResult result = beat(ledger, "w0", start, {lease.id}, 0);
  CHECK(result.left);
  CHECK(result.lost == std::vector{lease.id});
  CHECK(ledger.workers_alive() == 0);
  CHECK(ledger.state(0, 0) == TrialState::pending);
  CHECK(nothing_to_grant(ledger));
  beat(ledger, "w1", start);
  CHECK(must_grant(ledger).attempt == 1);
}

TEST_CASE("workers that fly only some agents get these flights; others complete the trial", "[ledger]") {
  LeaseLedger ledger({.trials = 400, .agents = 3});
  const auto beat_flying = [&](std::string_view name, std::vector<bool> flies, std::vector<std::uint64_t> leases = {}) {
    return ledger.heartbeat({name, 1, 1, leases, std::move(flies)}, start);
  };
  CHECK_THROWS_AS(beat_flying("odd", {true}), std::invalid_argument);
  beat_flying("middle", {false, true, false});
  const Lease first = must_grant(ledger);
  CHECK(first.agents == std::vector<std::uint32_t>{1});
  ledger.flight_stored(0, first.trial, 1);
  CHECK(ledger.state(0, first.trial) == TrialState::pending);
  // It may still list the lease that is over; the next one is of another trial.
  CHECK(beat_flying("middle", {false, true, false}, {first.id}).cancel == std::vector{first.id});
  for (std::uint32_t trial = 1; trial < 400; ++trial) {
    const Lease next = must_grant(ledger);
    CHECK(next.agents == std::vector<std::uint32_t>{1});
    ledger.flight_stored(0, next.trial, 1);
  }
  CHECK(nothing_to_grant(ledger));

  // The others find theirs, also behind hundreds that are not for them, and although "middle" is hungry before them.
  for (std::uint32_t trial = 0; trial < 399; ++trial) ledger.flight_stored(0, trial, 2);
  beat_flying("last", {false, false, true});
  std::vector<Lease> found;
  for (int look = 0; look < 3 && found.empty(); ++look)
    if (Lease lease; ledger.grant(start, lease)) found.push_back(lease);
  REQUIRE(found.size() == 1);
  CHECK(found[0].trial == 399);
  CHECK(found[0].agents == std::vector<std::uint32_t>{2});
  beat(ledger, "all", start);
  CHECK(must_grant(ledger).agents == std::vector<std::uint32_t>{0});
  for (std::uint32_t trial = 0; trial < 400; ++trial) ledger.flight_stored(0, trial, 0);
  CHECK(ledger.count(TrialState::done) == 399);
  ledger.flight_stored(0, 399, 2);
  CHECK(ledger.finished());
}

TEST_CASE("a worker's silence returns its trials to the queue, for others first", "[ledger]") {
  LeaseLedger ledger({.trials = 3, .agents = 2, .heartbeat_timeout = 3s});
  beat(ledger, "w0", start);
  beat(ledger, "w1", start);
  const Lease first = must_grant(ledger);
  const Lease second = must_grant(ledger);
  REQUIRE(first.worker == "w0");
  ledger.flight_stored(0, 0, 1);
  beat(ledger, "w1", start + 3s, {second.id});
  CHECK(ledger.expire(start + 3s).empty());
  const auto lost = ledger.expire(start + 3001ms);
  REQUIRE(lost.size() == 1);
  CHECK(lost[0].name == "w0");
  CHECK(lost[0].silent_for == 3001ms);
  CHECK(lost[0].leases == std::vector{first.id});
  CHECK(ledger.state(0, 0) == TrialState::lost);
  CHECK(ledger.workers_alive() == 1);

  CHECK(nothing_to_grant(ledger, start + 4s));  // w1 is busy
  ledger.flight_stored(0, 1, 0);
  ledger.flight_stored(0, 1, 1);
  const Lease retry = must_grant(ledger, start + 4s);
  CHECK(retry.worker == "w1");
  CHECK(retry.trial == 0);
  CHECK(retry.attempt == 2);
  CHECK(retry.agents == std::vector{0U});  // agent 1 is in the database
}

TEST_CASE("a trial that fails is tried max_attempts times, elsewhere if possible", "[ledger]") {
  LeaseLedger ledger({.trials = 2, .max_attempts = 2});
  beat(ledger, "w0", start);
  beat(ledger, "w1", start);
  const Lease first = must_grant(ledger);
  const Lease second = must_grant(ledger);
  ledger.lease_failed(first.id, "no command from dqn for 60 s");
  ledger.lease_failed(first.id, "the same again");  // duplicate
  CHECK(ledger.state(0, 0) == TrialState::pending);
  CHECK(beat(ledger, "w0", start, {first.id}).cancel == std::vector{first.id});  // given up is given up
  ledger.flight_stored(0, 1, 0);
  // Both workers are free; w0 stands first in line, but only it is left for a while.
  const Lease retry = must_grant(ledger);
  CHECK(retry.attempt == 2);
  CHECK(second.trial == 1);
  ledger.lease_failed(retry.id, "no command from dqn for 60 s");
  CHECK(ledger.state(0, 0) == TrialState::failed);
  CHECK(ledger.finished());
  REQUIRE(ledger.failures().size() == 1);
  CHECK(ledger.failures()[0].trial == 0);
  CHECK(ledger.failures()[0].reason == "no command from dqn for 60 s");

  SECTION("a late result heals it") {
    CHECK(ledger.flight_stored(0, 0, 0));
    CHECK(ledger.count(TrialState::failed) == 0);
    CHECK(ledger.failures().empty());
    CHECK(ledger.finished());
  }
}

TEST_CASE("a failed trial waits for another worker while there are fresh trials", "[ledger]") {
  LeaseLedger ledger({.trials = 4});
  beat(ledger, "w1", start);
  const Lease other = must_grant(ledger);
  beat(ledger, "w0", start);
  const Lease first = must_grant(ledger);
  ledger.lease_failed(first.id, "reason");
  const Lease next = must_grant(ledger);
  CHECK(next.worker == "w0");
  CHECK(next.trial == 2);
  beat(ledger, "w1", start, {other.id}, 2);
  CHECK(must_grant(ledger).trial == first.trial);
}

TEST_CASE("a failed trial does not wait if there is no other worker", "[ledger]") {
  LeaseLedger ledger({.trials = 3});
  beat(ledger, "w0", start);
  ledger.lease_failed(must_grant(ledger).id, "reason");
  CHECK(must_grant(ledger).trial == 0);
}

TEST_CASE("a trial under which workers vanish again and again fails", "[ledger]") {
  LeaseLedger ledger({.trials = 1, .max_losses = 3});
  for (int round = 0; round < 3; ++round) {
    REQUIRE_FALSE(ledger.finished());
    const auto now = start + round * 10s;
    beat(ledger, "w0", now);
    (void)must_grant(ledger, now);
    REQUIRE(ledger.expire(now + 5s).size() == 1);
  }
  CHECK(ledger.finished());
  CHECK(ledger.failures().at(0).reason == "3 workers were lost while they flew it");
}

TEST_CASE("a lease that its worker never lists is lost", "[ledger]") {
  LeaseLedger ledger({.trials = 2, .unclaimed_timeout = 5s});
  beat(ledger, "w0", start, {}, 2);
  const Lease first = must_grant(ledger);
  const Lease second = must_grant(ledger);
  CHECK(beat(ledger, "w0", start + 5s, {second.id}, 2).lost.empty());
  CHECK(beat(ledger, "w0", start + 6s, {second.id}, 2).lost == std::vector{first.id});
  CHECK(ledger.state(0, 0) == TrialState::lost);
  SECTION("but if it turns up before anyone else has the trial, it counts") {
    CHECK(beat(ledger, "w0", start + 7s, {first.id, second.id}, 2).adopted == std::vector{first.id});
    CHECK(ledger.state(0, 0) == TrialState::leased);
  }
  SECTION("if another has it, it is cancelled") {
    beat(ledger, "w1", start + 6s);
    // w0 stands in line first; the lost trial is all there is.
    for (Lease lease; ledger.grant(start + 6s, lease);) {
      if (lease.worker != "w1") ledger.lease_failed(lease.id, "make it go to w1");
    }
    CHECK(beat(ledger, "w0", start + 7s, {first.id, second.id}, 1).cancel == std::vector{first.id});
  }
}

TEST_CASE("a restarted worker loses its leases at once, except those it still lists", "[ledger]") {
  LeaseLedger ledger({.trials = 2});
  beat(ledger, "w0", start, {}, 2, 100);
  const Lease first = must_grant(ledger);
  const Lease second = must_grant(ledger);
  const auto result = beat(ledger, "w0", start + 1s, {first.id}, 2, 101);
  CHECK(result.joined);
  CHECK(result.lost == std::vector{second.id});
  CHECK(ledger.state(0, 0) == TrialState::leased);
  CHECK(must_grant(ledger, start + 1s).trial == second.trial);
}

TEST_CASE("a new coordinator adopts the leases that are in the air", "[ledger]") {
  LeaseLedger before({.conditions = 2, .trials = 3, .first_grant = 4000});
  beat(before, "w0", start, {}, 2);
  const Lease first = must_grant(before);
  const Lease second = must_grant(before);

  LeaseLedger after({.conditions = 2, .trials = 3, .first_grant = 9000});
  after.flight_stored(0, 0, 0);  // the first one came in meanwhile
  const auto result = beat(after, "w0", start, {first.id, second.id}, 2);
  CHECK(result.adopted == std::vector{second.id});
  CHECK(result.cancel == std::vector{first.id});
  CHECK(must_grant(after).trial == 2);
  CHECK(nothing_to_grant(after));
  CHECK(beat(after, "w1", start, {0xFFFFFFFF00000001U}).cancel.size() == 1);  // no such trial
}

TEST_CASE("lineages run in order", "[ledger]") {
  LeaseLedger ledger({.conditions = 2, .trials = 5, .lineages = 2, .order = TrialOrder::shuffled});
  beat(ledger, "w0", start, {}, 64);
  std::set<std::pair<std::uint32_t, std::uint32_t>> in_air;
  std::vector<std::uint32_t> next{0, 1, 0, 1};  // by condition * 2 + lineage
  while (!ledger.finished()) {
    for (Lease lease; ledger.grant(start, lease);) {
      std::uint32_t& expected = next[lease.condition * 2 + lease.trial % 2];
      REQUIRE(lease.trial == expected);
      expected += 2;
      in_air.emplace(lease.condition, lease.trial);
    }
    REQUIRE(in_air.size() <= 4);
    REQUIRE_FALSE(in_air.empty());
    const auto [condition, trial] = *in_air.rbegin();
    ledger.flight_stored(condition, trial, 0);
    in_air.erase({condition, trial});
  }
  CHECK(ledger.count(TrialState::done) == 10);
}

TEST_CASE("a lineage whose trial failed cannot go on, the others can", "[ledger]") {
  LeaseLedger ledger({.trials = 6, .max_attempts = 1, .lineages = 2});
  beat(ledger, "w0", start, {}, 1);
  const Lease lease = must_grant(ledger);
  REQUIRE(lease.trial == 0);
  ledger.lease_failed(lease.id, "broken");
  CHECK(ledger.count(TrialState::failed) == 3);
  CHECK(ledger.failures().at(2).reason == "its predecessor, trial 2, failed");
  for (Lease other; ledger.grant(start, other);) {
    CHECK(other.trial % 2 == 1);
    ledger.flight_stored(0, other.trial, 0);
  }
  CHECK(ledger.finished());
  SECTION("until a late result of that trial frees the next one") {
    ledger.flight_stored(0, 0, 0);
    CHECK_FALSE(ledger.finished());
    CHECK(must_grant(ledger).trial == 2);
  }
}

TEST_CASE("the shuffled order is a permutation that depends on the seed alone", "[ledger]") {
  const LedgerOptions options{.conditions = 2, .trials = 50, .order = TrialOrder::shuffled, .order_seed = 5};
  LedgerOptions other = options;
  other.order_seed = 6;
  LeaseLedger a(options);
  LeaseLedger b(options);
  LeaseLedger c(other);
  const auto order = trials_in_order(a, 1);
  CHECK(order == trials_in_order(b, 1));
  CHECK(order != trials_in_order(c, 1));
  CHECK_FALSE(std::is_sorted(order.begin(), order.end()));
  CHECK(std::set(order.begin(), order.end()).size() == 100);
}

TEST_CASE("what is stored is not flown again", "[ledger]") {
  LeaseLedger ledger({.trials = 3, .agents = 2});
  CHECK(ledger.flight_stored(0, 1, 0));
  CHECK(ledger.flight_stored(0, 1, 1));
  CHECK_FALSE(ledger.flight_stored(0, 1, 1));
  CHECK(ledger.flight_stored(0, 2, 0));
  CHECK(ledger.flights_stored() == 3);
  beat(ledger, "w0", start, {}, 5);
  CHECK(must_grant(ledger).agents == std::vector{0U, 1U});
  const Lease last = must_grant(ledger);
  CHECK(last.trial == 2);
  CHECK(last.agents == std::vector{1U});
  CHECK(nothing_to_grant(ledger));
}

TEST_CASE("impossible options and flights are refused", "[ledger]") {
  CHECK_THROWS_AS(LeaseLedger({.trials = 0}), std::invalid_argument);
  CHECK_THROWS_AS(LeaseLedger({.conditions = 1U << 31U, .trials = 2}), std::invalid_argument);
  CHECK_THROWS_AS(LeaseLedger({.agents = 0}), std::invalid_argument);
  CHECK_THROWS_AS(LeaseLedger({.max_attempts = 256}), std::invalid_argument);
  LeaseLedger ledger({.conditions = 2, .trials = 3, .agents = 1});
  CHECK_THROWS_AS(ledger.flight_stored(2, 0, 0), std::out_of_range);
  CHECK_THROWS_AS(ledger.flight_stored(0, 3, 0), std::out_of_range);
  CHECK_THROWS_AS(ledger.flight_stored(0, 0, 1), std::out_of_range);
  CHECK_FALSE(ledger.trial_of(6ULL << 32U));
  CHECK(ledger.trial_of(5ULL << 32U) == std::pair{1U, 2U});
}
