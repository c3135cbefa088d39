#include "common/base/cores.hpp"

#include <sched.h>
#include <unistd.h>

#include <algorithm>
#include <catch2/catch.hpp>
#include <filesystem>
#include <fstream>
#include <map>
#include <optional>
#include <string>

namespace {

/// `cores`, or the quota of this machine if that is smaller.
unsigned within_quota(unsigned cores) {
  return std::min(cores, aloft::quota_cores("/proc/self/cgroup", "/sys/fs/cgroup").value_or(cores));
}

void write(const std::filesystem::path& file, const std::string& text) {
  std::filesystem::create_directories(file.parent_path());
  std::ofstream(file) << text;
}

}  // namespace

TEST_CASE("a quota of a control group counts as cores, rounded up", "[cores]") {
  const auto folder = std::filesystem::temp_directory_path() / ("aloft-cores-test-" + std::to_string(getpid()));
  std::filesystem::remove_all(folder);
  const auto memberships = folder / "cgroup";
  const auto root = folder / "fs";
  const auto cores = [&] { return aloft::quota_cores(memberships, root); };
  CHECK(cores() == std::nullopt);  // no control groups

  SECTION("version 2") {
    write(memberships, "0::/user.slice/job.scope\n");
    write(root / "user.slice/job.scope/cpu.max", "max 100000\n");
    CHECK(cores() == std::nullopt);
    write(root / "user.slice/job.scope/cpu.max", "250000 100000\n");
    CHECK(cores() == 3U);
    write(root / "user.slice/cpu.max", "150000 100000\n");  // the group above allows less
    CHECK(cores() == 2U);
    write(root / "cpu.max", "1000 100000\n");  // as seen from within a container
    CHECK(cores() == 1U);
  }
  SECTION("version 1") {
    write(memberships, "4:memory:/\n2:cpu,cpuacct:/docker/0123\n1:name=systemd:/\n");
    write(root / "memory/cpu.max", "100000 100000\n");  // not where limits of the CPU are
    write(root / "cpu/cpu.cfs_quota_us", "-1\n");
    write(root / "cpu/cpu.cfs_period_us", "100000\n");
    CHECK(cores() == std::nullopt);
    write(root / "cpu/cpu.cfs_quota_us", "400000\n");
    CHECK(cores() == 4U);
    write(root / "cpu/docker/0123/cpu.cfs_quota_us", "120000\n");
    write(root / "cpu/docker/0123/cpu.cfs_period_us", "60000\n");
    CHECK(cores() == 2U);
  }
  SECTION("damaged") {
    write(memberships, "nonsense\n0:\n0::\n");
    write(root / "cpu.max", "many\n");
    CHECK(cores() == std::nullopt);
  }
  std::filesystem::remove_all(folder);
}

TEST_CASE("cores that this process may not use do not count", "[cores]") {
  cpu_set_t before;
  REQUIRE(sched_getaffinity(0, sizeof before, &before) == 0);
  CHECK(aloft::usable_cores() == within_quota(static_cast<unsigned>(CPU_COUNT(&before))));
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
      CHECK(aloft::usable_cores() >= within_quota(std::max(1U, cores / shares)));
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
    CHECK(aloft::usable_cores() == within_quota(cores));
  }
}
