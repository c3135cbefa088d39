#include "tools/doctor/leftovers.hpp"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <fstream>
#include <map>
#include <set>
#include <string_view>
#include <utility>

#include "common/base/descriptor.hpp"

namespace aloft::doctor {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view lock_suffix = "_el";

/// The segment or port that a file belongs to, e.g. "fastrtps_port7410" for "sem.fastrtps_port7410_mutex"; empty if the
/// file is not Fast DDS's. Its names begin with fastrtps_ in 2.x and with fastdds_ in 3.x.
std::string owner_of(std::string name) {
  const auto cut = [&](std::string_view suffix) {
    if (name.size() > suffix.size() && name.ends_with(suffix)) name.resize(name.size() - suffix.size());
  };
  if (name.starts_with("sem.")) name.erase(0, 4);
  cut("_mutex");
  cut(lock_suffix);
  return name.starts_with("fastrtps_") || name.starts_with("fastdds_") ? name : "";
}

/// Holds the lock of a segment until it is closed; not open if another process has the lock.
Descriptor locked(const fs::path& file) {
  Descriptor lock(open(file.c_str(), O_RDWR | O_CLOEXEC));
  return lock.is_open() && flock(lock.get(), LOCK_EX | LOCK_NB) == 0 ? std::move(lock) : Descriptor();
}

std::set<std::string> mapped_files() {
  std::set<std::string> files;
  std::error_code ignored;
  for (const auto& process : fs::directory_iterator("/proc", ignored)) {
    std::ifstream maps(process.path() / "maps");
    for (std::string line; std::getline(maps, line);)
      if (const std::size_t at = line.find('/'); at != std::string::npos) files.insert(line.substr(at));
  }
  return files;
}

bool mine(const fs::path& file) {
  struct stat facts {};
  return lstat(file.c_str(), &facts) == 0 && S_ISREG(facts.st_mode) && facts.st_uid == geteuid();
}

const fs::path* lock_of(const Leftover& leftover) {
  const auto at =
      std::ranges::find_if(leftover.files, [](const fs::path& file) { return file.string().ends_with(lock_suffix); });
  return at == leftover.files.end() ? nullptr : &*at;
}

}  // namespace

std::vector<Leftover> find_leftovers(const fs::path& dir) {
  std::map<std::string, Leftover> groups;
  std::error_code ignored;
  for (const auto& entry : fs::directory_iterator(dir, ignored)) {
    const std::string owner = owner_of(entry.path().filename().string());
    if (owner.empty()) continue;
    groups[owner].files.push_back(entry.path());
    groups[owner].bytes += entry.file_size(ignored);
  }
  std::vector<Leftover> dead;
  if (groups.empty()) return dead;
  const std::set<std::string> mapped = mapped_files();
  for (auto& [owner, leftover] : groups) {
    const fs::path* lock_file = lock_of(leftover);
    const bool ours = std::ranges::all_of(leftover.files, mine);
    const bool used =
        std::ranges::any_of(leftover.files, [&](const fs::path& file) { return mapped.contains(file.string()); });
    if (lock_file == nullptr || !ours || used || !locked(*lock_file).is_open()) continue;
    std::ranges::sort(leftover.files);
    dead.push_back(std::move(leftover));
  }
  return dead;
}

std::size_t remove_leftovers(const std::vector<Leftover>& leftovers) {
  std::size_t removed = 0;
  for (const Leftover& leftover : leftovers) {
    const Descriptor lock = locked(*lock_of(leftover));
    if (!lock.is_open()) continue;
    std::error_code error;
    for (const fs::path& file : leftover.files) fs::remove(file, error);
    removed += error ? 0U : 1U;
  }
  return removed;
}

}  // namespace aloft::doctor
