#include "tests/own_mounts.hpp"

#include <sched.h>
#include <sys/mount.h>
#include <unistd.h>

#include <fstream>

#include "tests/skip.hpp"

namespace aloft::test {
namespace {

void write_line(const char* file, const std::string& text) {
  std::ofstream(file) << text;
}

bool unshare_mounts() {
  const std::string user = std::to_string(getuid());
  const std::string group = std::to_string(getgid());
  if (unshare(CLONE_NEWNS) != 0) {
    if (unshare(CLONE_NEWUSER | CLONE_NEWNS) != 0) return false;
    write_line("/proc/self/setgroups", "deny");
    write_line("/proc/self/uid_map", "0 " + user + " 1");
    write_line("/proc/self/gid_map", "0 " + group + " 1");
  }
  return mount("none", "/", nullptr, MS_REC | MS_PRIVATE, nullptr) == 0;
}

}  // namespace

bool own_mounts() {
  if (unshare_mounts()) return true;
  skip(
      "this user may not mount a tmpfs here: run as root, or allow unprivileged user namespaces (sysctl "
      "kernel.unprivileged_userns_clone=1)");
  return false;
}

}  // namespace aloft::test
