// Datagrams that exploit faults of the middleware, into a running system: docs/vulnerabilities.md.
#include <unistd.h>

#include <algorithm>
#include <catch2/catch.hpp>
#include <filesystem>
#include <thread>

#include "common/bus/endpoint.hpp"
#include "common/bus/guard/testing/bad_datagrams.hpp"
#include "common/bus/participant.hpp"
#include "common/security/keys.hpp"
#include "tests/faults/attacker.hpp"
#include "tests/faults/effort.hpp"
#include "tests/faults/fault_scene.hpp"

using namespace aloft;
using namespace aloft::test;
using namespace aloft::bus::guard::testing;
using namespace std::chrono_literals;
using Catch::Contains;

namespace {

/// CVE-2025-64438: so many missing samples, each remembered by itself.
Bytes wide_gap(std::int64_t samples) {
  return datagram({gap(true, 2, 2 + samples, 0, publications)});
}

/// By how much this process grows when a participant in it gets a wide gap.
std::size_t growth_by_gap(bool guarded) {
  constexpr std::int64_t samples = 2'000'000;
  bus::BusOptions place;
  place.run = own_name("gap");
  place.process = "victim";
  place.domain = std::stoi(test_domain());
  place.guarded = guarded;
  const bus::Participant victim(place);
  const Attacker attacker(place.domain);
  attacker.announce(prefix_of(1), 100);
  std::this_thread::sleep_for(1s);
  const std::size_t before = resident_bytes(getpid());
  const auto growth = [&] {
    const std::size_t now = resident_bytes(getpid());
    return now > before ? now - before : 0;
  };
  if (guarded) {
    attacker.send(wide_gap(samples));
    CHECK(eventually(10s, [&] { return victim.refused().at(static_cast<std::size_t>(bus::Refusal::gap)) > 0; }));
    std::this_thread::sleep_for(500ms);
  } else {
    (void)eventually(20s, [&] {
      attacker.announce(prefix_of(1), 100);
      attacker.send(wide_gap(samples));
      return growth() > 5 * allowed_growth_bytes;
    });
  }
  return growth();
}

/// Every kind of bad datagram, from a participant that has announced itself.
void send_all(const Attacker& attacker) {
  // Its lease is short: a participant that acknowledges nothing delays that stopped processes are found again.
  attacker.announce(prefix_of(1), 3);
  std::this_thread::sleep_for(300ms);
  for (const bool little : {true, false})
    for (const auto& bad : bad_datagrams(little)) attacker.send(bad.bytes);
  attacker.send(wide_gap(1'000'000'000));
}

}  // namespace

TEST_CASE("one datagram makes a process grow without the guard, and not with it", "[guard]") {
  CHECK(growth_by_gap(true) < allowed_growth_bytes);
  CHECK(growth_by_gap(false) > 5 * allowed_growth_bytes);
}

TEST_CASE("a process counts what its guard refuses by reason, and goes on: secured and not", "[guard]") {
  using bus::Refusal;
  const ScratchDir scratch;
  const std::filesystem::path keys = scratch.path() / "keys";
  security::init_keys(keys, 10);
  for (const auto role : {security::Role::channel, security::Role::environment})
    security::issue_keys(keys, {.role = role, .name = std::string(security::to_text(role))}, bus::topic_rights(role),
                         keys);
  for (const bool secured : {false, true}) {
    if (secured && !bus::secured_run_objection().empty()) continue;
    INFO((secured ? "secured" : "not secured"));
    bus::BusOptions place;
    place.run = own_name("counts");
    place.domain = std::stoi(test_domain());
    place.role = security::Role::channel;
    if (secured) place.secure = keys;
    const bus::Participant victim(place);
    const Attacker attacker(place.domain);
    send_all(attacker);
    std::this_thread::sleep_for(500ms);
    const std::size_t before = resident_bytes(getpid());
    for (int round = 0; round < 20; ++round) send_all(attacker);
    const bus::RefusalCounts counts = victim.refused();
    for (auto reason = Refusal::header; reason <= Refusal::endpoint;
         reason = static_cast<Refusal>(static_cast<int>(reason) + 1)) {
      INFO(bus::name(reason));
      CHECK(counts.at(static_cast<std::size_t>(reason)) > 0);
    }
    if (memory_tells) CHECK(resident_bytes(getpid()) < before + allowed_growth_bytes);

    bus::Writer<wire::WorkerStatus> writer(victim);
    place.role = security::Role::environment;
    const bus::Participant peer(place);
    bus::Reader<wire::WorkerStatus> reader(peer);
    CHECK(eventually(30s, [&] { return writer.matched() == 1 && reader.matched() == 1; }));
  }
}

/// Without the rule of the guard (DatagramGuard::admit) this program is aborted within a few rounds.
TEST_CASE("participants that leave when their lease ends do not stop a process", "[guard]") {
  using Clock = std::chrono::steady_clock;
  bus::BusOptions place;
  place.run = own_name("farewells");
  place.domain = std::stoi(test_domain());
  const bus::Participant victim(place);
  const Attacker attacker(place.domain);
  constexpr std::uint32_t participants = 200;
  std::uint32_t next = 1'000'000;
  for (int round = 0; round < effort(4, 100); ++round, next += participants) {
    std::vector<Clock::time_point> announced;
    for (std::uint32_t i = 0; i < participants; ++i) {
      announced.push_back(Clock::now());
      attacker.announce(prefix_of(next + i), 1);
      std::this_thread::sleep_until(announced.front() + (i + 1) * 4ms);
    }
    for (std::uint32_t i = 0; i < participants; ++i) {
      // The lease begins when the announcement is read, some ten microseconds after it was sent.
      std::this_thread::sleep_until(announced.at(i) + 1s + (static_cast<int>(i % 10) - 5) * 50us);
      attacker.send(datagram({farewell(true, prefix_of(next + i))}, prefix_of(next + i)));
    }
  }
  place.process = "peer";
  const bus::Participant peer(place);
  bus::Writer<wire::WorkerStatus> writer(victim);
  bus::Reader<wire::WorkerStatus> reader(peer);
  CHECK(eventually(10s, [&] { return writer.matched() == 1 && reader.matched() == 1; }));
}

TEST_CASE("datagrams for known faults of the middleware neither stop processes nor make them grow", "[guard]") {
  const FaultScene scene(effort(40, 300));
  const std::string name = "attacked";
  const std::string run_name = own_name("attacked");
  const auto run = scene.start(name, {"--workers", "2", "--run", run_name});
  scene.wait_for_flights(name, *run, scene.flights() / 8);
  const auto processes = {"aloft-coordinator", "aloft-metrics", "aloft-channel-w0", "aloft-learning-agent-w1"};
  REQUIRE(eventually(30s, [&] {  // a worker can fly before the other one has started
    return std::ranges::none_of(processes, [&](const char* process) { return scene.log(name, process).empty(); });
  }));
  HeldRun held(scene, name, *run);
  const Attacker attacker(std::stoi(test_domain()));
  for (int round = 0; round < effort(3, 50); ++round) {
    send_all(attacker);
    for (int i = 0; i < 100; ++i) attacker.send(wide_gap(bus::guard::widest_gap + i * 7));
  }
  held.check_growth("bad datagrams");
  for (std::uint32_t forged = 1000; forged < static_cast<std::uint32_t>(effort(2500, 25'000)); ++forged)
    attacker.announce(prefix_of(forged), 2);
  held.check_growth("forged participants");
  held.go_on();
  scene.check_finished(name, *run, 120s);
  for (const char* process : processes)
    CHECK_THAT(scene.log(name, process), Contains("refused a datagram from 127.0.0.1"));
  CHECK(run->error_so_far().find("starting it again") == std::string::npos);
}
