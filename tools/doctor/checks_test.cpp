#include "tools/doctor/checks.hpp"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/mman.h>
#include <unistd.h>

#include <catch2/catch.hpp>
#include <cstdlib>
#include <filesystem>

#include "common/security/keys.hpp"
#include "tests/integration/command.hpp"
#include "tools/doctor/leftovers.hpp"

using namespace aloft;
using Catch::Contains;
using doctor::State;
namespace fs = std::filesystem;

TEST_CASE("leftovers are Fast DDS's files that nobody locks or maps, and only they are removed", "[doctor]") {
  const std::string prefix = GENERATE(as<std::string>{}, "fastrtps_", "fastdds_");
  const test::ScratchDir dir;
  const std::string kilobyte(1024, 'x');
  for (const std::string& name : std::vector<std::string>{
           prefix + "dead", prefix + "dead_el", prefix + "port7411", prefix + "port7411_el",
           "sem." + prefix + "port7411_mutex", prefix + "locked", prefix + "locked_el", prefix + "mapped",
           prefix + "mapped_el", prefix + "without_lock", "somebody_else", "somebody_else_el"})
    test::write_text(dir / name, kilobyte);
  const int lock = open((dir / (prefix + "locked_el")).c_str(), O_RDWR);
  REQUIRE(flock(lock, LOCK_SH) == 0);
  const int mapped = open((dir / (prefix + "mapped")).c_str(), O_RDWR);
  void* const memory = mmap(nullptr, kilobyte.size(), PROT_READ, MAP_SHARED, mapped, 0);
  REQUIRE(memory != MAP_FAILED);

  const auto leftovers = doctor::find_leftovers(dir.path());
  REQUIRE(leftovers.size() == 2);
  CHECK(leftovers[0].files == std::vector<fs::path>{dir / (prefix + "dead"), dir / (prefix + "dead_el")});
  CHECK(leftovers[1].files.size() == 3);
  CHECK(leftovers[1].bytes == 3 * 1024);

  const auto seen = doctor::check_leftovers(dir.path(), false);
  CHECK(seen.state == State::warning);
  CHECK_THAT(seen.text, Contains("2 segments"));
  CHECK(fs::exists(dir / (prefix + "dead")));
  CHECK_THAT(doctor::check_leftovers(dir.path(), true).text, Contains("removed 2"));
  for (const std::string& name :
       std::vector<std::string>{prefix + "dead", prefix + "dead_el", "sem." + prefix + "port7411_mutex"})
    CHECK_FALSE(fs::exists(dir / name));
  for (const std::string& name :
       std::vector<std::string>{prefix + "locked", prefix + "mapped", prefix + "without_lock", "somebody_else"})
    CHECK(fs::exists(dir / name));
  CHECK(doctor::check_leftovers(dir.path(), false).state == State::ok);
  munmap(memory, kilobyte.size());
  close(mapped);
  close(lock);
}

TEST_CASE("the middleware is named, and a file of settings for it that the environment names", "[doctor]") {
  for (const char* name : {"FASTRTPS_DEFAULT_PROFILES_FILE", "FASTDDS_DEFAULT_PROFILES_FILE"}) {
    unsetenv(name);
    const auto plain = doctor::check_middleware();
    CHECK(plain.state == State::ok);
    CHECK(plain.text == bus::middleware());
    setenv(name, "/a/file.xml", 1);
    const auto seen = doctor::check_middleware();
    unsetenv(name);
    CHECK(seen.state == State::warning);
    CHECK_THAT(seen.text, Contains(std::string(name) + " names /a/file.xml"));
    CHECK_THAT(seen.advice, Contains("unset"));
  }
}

TEST_CASE("a folder that cannot be written is a problem, one that is yet to be made is not", "[doctor]") {
  const test::ScratchDir dir;
  CHECK(doctor::check_results(dir / "new").state != State::problem);
  CHECK_FALSE(fs::exists(dir / "new"));
  test::write_text(dir / "file", "x");
  CHECK(doctor::check_results(dir / "file").state == State::problem);
  CHECK(doctor::check_results("/proc/aloft").state == State::problem);
}

TEST_CASE("socket buffers below 4 MiB are named with the command that raises them", "[doctor]") {
  CHECK(doctor::check_socket_buffers(4U << 20U, 4U << 20U).state == State::ok);
  const auto small = doctor::check_socket_buffers(212992, 4U << 20U);
  CHECK(small.state == State::warning);
  CHECK_THAT(small.text, Contains("at most 208 KB to receive"));
  CHECK_THAT(small.advice, Contains("net.core.rmem_max=4194304"));
}

TEST_CASE("a domain has room for 120 processes, two ports each", "[doctor]") {
  // RTPS 2.2, 9.6.1.1: unicast ports are 7400 + 250 d + 10 + 2 p and one more.
  std::vector<int> ports{53, 7400, 7650, 7401};
  CHECK_THAT(doctor::check_domain(1, ports).text, Contains("0 processes"));
  for (int p = 0; p < 3; ++p) ports.insert(ports.end(), {7660 + 2 * p, 7661 + 2 * p});
  CHECK_THAT(doctor::check_domain(1, ports).text, Contains("3 processes"));
  CHECK_THAT(doctor::check_domain(0, ports).text, Contains("0 processes"));
  for (int p = 3; p < 120; ++p) ports.push_back(7660 + 2 * p);
  const auto full = doctor::check_domain(1, ports);
  CHECK(full.state == State::problem);
  CHECK_THAT(full.advice, Contains("--domain"));
}

TEST_CASE("ports in use are read from the kernel", "[doctor]") {
  bus::BusOptions place;
  place.domain = 100;
  const bus::Participant participant(place);
  const auto ports = doctor::udp_ports_in_use();
  CHECK(std::any_of(ports.begin(), ports.end(), [](int port) { return port >= 32410 && port < 32650; }));
}

TEST_CASE("keys of every role there is are looked at", "[doctor]") {
  const test::ScratchDir dir;
  CHECK(doctor::check_keys(dir.path()).front().state == State::problem);
  security::init_keys(dir / "keys", 10);
  security::issue_keys(dir / "keys", {.role = security::Role::channel, .name = "a"}, {}, dir / "keys");
  security::issue_keys(dir / "keys", {.role = security::Role::metrics, .name = "a", .days = 1, .first_day = -5}, {},
                       dir / "keys");
  const auto findings = doctor::check_keys(dir / "keys");
  REQUIRE(findings.size() == 2);
  CHECK(findings[0].state == State::problem);
  CHECK_THAT(findings[0].text, Contains("metrics/cert.pem: expired"));
  CHECK(findings[1].state == State::ok);
}

TEST_CASE("a CPU without the kernels' instructions is a warning", "[doctor]") {
  CHECK(doctor::check_cpu("avx2").state == State::ok);
  CHECK(doctor::check_cpu("avx512").state == State::ok);
  CHECK(doctor::check_cpu("portable").state == State::warning);
  CHECK_FALSE(doctor::check_cpu("portable").advice.empty());
  CHECK_FALSE(doctor::check_cpu().text.empty());
}
