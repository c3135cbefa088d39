#include "common/base/cores.hpp"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <string>
#include <thread>

namespace aloft {
namespace {

unsigned cores_by_affinity() {
  cpu_set_t cores;
  if (sched_getaffinity(0, sizeof cores, &cores) == 0) return static_cast<unsigned>(std::max(1, CPU_COUNT(&cores)));
  return std::max(1U, std::thread::hardware_concurrency());  // more cores than the set can name
}

/// CPU seconds per second that this one group allows; nothing if it sets no limit.
std::optional<double> quota_of(const std::filesystem::path& group) {
  double quota = 0.0;
  double period = 0.0;
  std::ifstream version2(group / "cpu.max");                 // "200000 100000", or "max 100000"
  std::ifstream version1_quota(group / "cpu.cfs_quota_us");  // -1: none
  std::ifstream version1_period(group / "cpu.cfs_period_us");
  const bool known = (version2 >> quota >> period) || ((version1_quota >> quota) && (version1_period >> period));
  if (!known || quota <= 0.0 || period <= 0.0) return std::nullopt;
  return quota / period;
}

}  // namespace

std::optional<unsigned> quota_cores(const std::filesystem::path& memberships,
                                    const std::filesystem::path& hierarchies) {
  std::optional<double> least;
  std::ifstream lines(memberships);
  for (std::string line; std::getline(lines, line);) {  // number:controllers:path
    const auto first = line.find(':');
    const auto second = line.find(':', first + 1);
    if (second == std::string::npos) continue;
    const std::string controllers = "," + line.substr(first + 1, second - first - 1) + ",";
    if (controllers != ",," && controllers.find(",cpu,") == std::string::npos) continue;
    const auto root = controllers == ",," ? hierarchies : hierarchies / "cpu";
    // The group and all its parents; in a container the path can be the host's, where only the root is visible.
    for (std::filesystem::path path = line.substr(second + 1);; path = path.parent_path()) {
      const auto quota = quota_of(root / path.relative_path());
      if (quota) least = std::min(least.value_or(*quota), *quota);
      if (!path.has_relative_path()) break;
    }
  }
  if (!least) return std::nullopt;
  return static_cast<unsigned>(std::max(1.0, std::ceil(*least)));
}

unsigned usable_cores() {
  const unsigned cores = cores_by_affinity();
  return std::min(cores, quota_cores("/proc/self/cgroup", "/sys/fs/cgroup").value_or(cores));
}

OnCores::OnCores(const CoreShare& share) noexcept
    : changed_(share.of > 1 && sched_getaffinity(0, sizeof before_, &before_) == 0) {
  if (!changed_) return;
  const auto cores = static_cast<unsigned>(CPU_COUNT(&before_));
  const unsigned first = share.part * cores / share.of;
  const unsigned last = std::max(first + 1, (share.part + 1) * cores / share.of);  // one past the end
  cpu_set_t ours;
  CPU_ZERO(&ours);
  unsigned place = 0;
  for (unsigned core = 0; core < CPU_SETSIZE; ++core) {
    if (!CPU_ISSET(core, &before_)) continue;
    if (place >= first && place < last) CPU_SET(core, &ours);
    ++place;
  }
  sched_setaffinity(0, sizeof ours, &ours);
}

OnCores::~OnCores() {
  if (changed_) sched_setaffinity(0, sizeof before_, &before_);
}

}  // namespace aloft
