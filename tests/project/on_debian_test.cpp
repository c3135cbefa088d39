// tools/on_debian.sh makes a root of another release of Debian and runs commands in it. debootstrap and chroot are
// stand-ins; mounts, namespaces and processes are real.
#include <unistd.h>

#include <catch2/catch.hpp>
#include <csignal>
#include <thread>

#include "tests/own_mounts.hpp"
#include "tests/paths.hpp"
#include "tests/project/scripts.hpp"

namespace fs = std::filesystem;
using namespace aloft::test;
using Catch::Contains;

namespace {

/// A checkout on a machine whose apt knows a mirror, and whose debootstrap makes the empty folders of a root. In the
/// root the command "sh -c CODE" runs as outside of it; others only print how they were called.
class Machine {
 public:
  Machine() {
    scripts_.copy("tools/on_debian.sh");
    fs::create_directories(root() / "cache");
    scripts_.write_program("bin/apt-get",
                           "[ $1 != indextargets ] || printf 'bookworm http://mirror/main/\\n"
                           "bookworm-security http://mirror/security/\\n'\n");
    scripts_.write_program("bin/apt-config", "[ $1 != dump ] || echo 'Acquire::Retries \"3\";'\n");
    scripts_.write_program(
        "bin/debootstrap",
        "echo \"debootstrap $*\"\nfor last; do root=$codename; codename=$before; before=$last; done\n"
        "mkdir \"$codename\" || exit 1\ncd \"$codename\"\n"
        "[ ! -e " +
            (root() / "interrupt").string() + " ] || exit 130\n" +
            "mkdir -p proc sys dev/shm tmp run root etc/apt/apt.conf.d etc/dpkg/dpkg.cfg.d usr/sbin "
            "usr/local/share\n");
    scripts_.write_program("bin/chroot",
                           "while [ \"$1\" != sh ]; do shift; done\nshift\necho \"in the root: $*\"\n"
                           "[ \"$1 $2\" != 'sh -c' ] || exec \"$@\"\n");
  }

  /// As a shell command, for a user called root.
  [[nodiscard]] std::string command(const std::string& arguments) const {
    return "cd / && exec env --default-signal HOME=" + root().string() + " XDG_CACHE_HOME=" + cache().string() +
           " PATH=" + (root() / "bin").string() + ":$PATH " + (root() / "tools/on_debian.sh").string() + " " +
           arguments;
  }
  [[nodiscard]] Finished on(const std::string& arguments) const {
    return run_command({"/bin/bash", "-c", command(arguments)});
  }
  void write_program(const std::string& program, const std::string& code) const {
    scripts_.write_program(program, code);
  }
  [[nodiscard]] fs::path root() const { return scripts_.root(); }
  [[nodiscard]] fs::path cache() const { return root() / "cache"; }

 private:
  Scripts scripts_;
};

std::string link_of(const fs::path& link) {
  return fs::read_symlink(link).string();
}

/// Waits until nothing runs whose command line has `text`.
bool all_gone(const std::string& text) {
  for (int i = 0; i < 100; ++i) {
    if (processes_with(text).empty()) return true;
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
  }
  return false;
}

}  // namespace

TEST_CASE("a machine on which no root can be made says why and fails") {
  const Machine machine;
  const auto refused = [&](const std::string& arguments, const std::string& why) {
    const Finished finished = machine.on(arguments);
    INFO(arguments << ": " << finished.err);
    CHECK(finished.exit_code == 2);
    CHECK_THAT(finished.err, Contains(why));
    CHECK(finished.out.empty());
    CHECK(fs::is_empty(machine.cache()));
  };
  refused("", "'' is no release that Aloft supports; use debian12 or debian13");
  refused("debian11 true", "'debian11' is no release that Aloft supports; use debian12 or debian13");
  refused("debian13", "name the command to run");
  refused("debian13 --for fun true", "'fun' is unknown; use flight, programs, tests, integration, packages or python");
  machine.write_program("bin/id", "echo 1000\n");
  refused("debian13 true", "by root only: run it as root");
  machine.write_program("bin/id", "echo 0\n");
  machine.write_program("bin/unshare", "exit 1\n");
  refused("debian13 true", "this machine allows no namespaces");

  machine.write_program("bin/unshare", "exit 0\n");
  machine.write_program("bin/apt-get", "exit 0\n");
  const Finished no_mirror = machine.on("debian13 true");
  CHECK(no_mirror.exit_code == 2);
  CHECK_THAT(no_mirror.err, Contains("the sources of this machine's apt name no mirror of Debian"));

  for (const char* missing : {"debootstrap", "unshare", "setpriv", "ip", "chroot", "flock"}) {
    const ScratchDir few;
    for (const char* program : {"bash", "dirname"}) fs::create_symlink("/bin/" + std::string(program), few / program);
    for (const char* program : {"id", "debootstrap", "unshare", "setpriv", "ip", "chroot", "flock"})
      if (program != std::string(missing)) fs::create_symlink(machine.root() / "bin/id", few / program);
    const Finished finished = run_command({"/bin/bash", "-c",
                                           "HOME=/nowhere PATH=" + few.path().string() + " " +
                                               (machine.root() / "tools/on_debian.sh").string() + " debian13 true"});
    CHECK(finished.exit_code == 2);
    CHECK_THAT(finished.err, Contains("without '" + std::string(missing) + "'") && Contains("tools/setup.sh"));
  }
}

TEST_CASE("a root is made once, from the mirror of the machine, outside of the checkout", "[needs-mounts]") {
  if (!own_mounts()) return;
  const Machine machine;
  const fs::path root = machine.cache() / "aloft/roots/debian13";
  const Finished first = machine.on("debian13 tools/test.sh unit");
  INFO(first.err);
  REQUIRE(first.exit_code == 0);
  CHECK_THAT(first.out, Contains("debootstrap --variant=minbase") &&
                            Contains("trixie " + root.string() + " http://mirror/main/\n"));
  CHECK_THAT(first.out,
             Catch::EndsWith("in the root: tools/setup.sh --for tests --install\nin the root: tools/test.sh unit\n"));
  CHECK(read_text(root / "etc/apt/sources.list") ==
        "deb http://mirror/main/ trixie main\ndeb http://mirror/main/ trixie-updates main\n"
        "deb http://mirror/security/ trixie-security main\n");
  CHECK_THAT(read_text(root / "etc/apt/apt.conf.d/90machine"), Contains("Acquire::Retries \"3\";\n"));

  const Finished second = machine.on("debian13 --for integration true");
  CHECK(second.exit_code == 0);
  CHECK(second.out == "in the root: tools/setup.sh --for integration --install\nin the root: true\n");
  CHECK_THAT(machine.on("debian12 true").out,
             Contains("bookworm " + (machine.cache() / "aloft/roots/debian12").string()));
}

TEST_CASE("a fresh root is deleted after its command, also when that fails", "[needs-mounts]") {
  if (!own_mounts()) return;
  const Machine machine;
  const fs::path roots = machine.cache() / "aloft/roots";
  REQUIRE(machine.on("debian12 sh -c 'touch " + (roots / "debian12/checkout/build/used").string() + "'").exit_code ==
          0);
  const Finished build = machine.on("debian12 --fresh sh -c 'ls " + roots.string() + "/fresh.*/root/checkout/build'");
  INFO(build.err);
  CHECK(build.exit_code == 0);
  CHECK(build.out.find("used") == std::string::npos);
  fs::remove_all(roots);
  fs::create_directories(roots);
  for (const char* code : {"0", "7"}) {
    const Finished finished = machine.on("debian13 --fresh sh -c 'ls -d " + roots.string() + "/*; exit " + code + "'");
    INFO(finished.err);
    CHECK(finished.exit_code == std::stoi(code));
    CHECK_THAT(finished.out, Contains("debootstrap --variant=minbase") && Contains(roots.string() + "/fresh."));
    CHECK(finished.out.find("tools/setup.sh") == std::string::npos);
    CHECK(fs::is_empty(roots));
  }
  write_text(machine.root() / "interrupt", "");
  CHECK(machine.on("debian13 --fresh true").exit_code == 130);
  CHECK(fs::is_empty(roots));
}

TEST_CASE("a root that was interrupted or whose packages failed is made anew", "[needs-mounts]") {
  if (!own_mounts()) return;
  const Machine machine;
  write_text(machine.root() / "interrupt", "");
  CHECK(machine.on("debian13 true").exit_code == 130);
  fs::remove(machine.root() / "interrupt");
  const fs::path left = machine.cache() / "aloft/roots/debian13/left";
  write_text(left, "");
  CHECK_THAT(machine.on("debian13 true").out, Contains("debootstrap"));
  CHECK_FALSE(fs::exists(left));

  const std::string chroot = read_text(machine.root() / "bin/chroot");
  machine.write_program("bin/chroot", "exit 100\n");
  CHECK(machine.on("debian13 true").exit_code == 100);
  write_text(machine.root() / "bin/chroot", chroot);
  CHECK_THAT(machine.on("debian13 true").out, Contains("debootstrap"));
  CHECK(machine.on("debian13 true").out.find("debootstrap") == std::string::npos);
}

TEST_CASE("a command in a root has its own build folders, mounts, processes and network", "[needs-mounts]") {
  if (!own_mounts()) return;
  const Machine machine;
  const auto in_root = [&](const std::string& code) {
    const Finished finished = machine.on("debian13 " + code);
    INFO(finished.err);
    CHECK(finished.exit_code == 0);
    const std::string mark = "in the root: sh -c ";
    const std::size_t line = finished.out.rfind(mark);
    return finished.out.substr(finished.out.find('\n', line) + 1);
  };
  const fs::path root = machine.cache() / "aloft/roots/debian13";
  const std::string checkout = (root / "checkout").string();
  CHECK(in_root("sh -c 'readlink /proc/self/ns/net'") != link_of("/proc/self/ns/net") + "\n");
  CHECK(in_root("--online sh -c 'readlink /proc/self/ns/net'") == link_of("/proc/self/ns/net") + "\n");
  CHECK_THAT(in_root("sh -c 'ip link show lo; ip route'"),
             Contains("MULTICAST") && Contains("UP") && Contains("224.0.0.0/4 dev lo"));
  CHECK(in_root("sh -c 'echo $$'").size() < 4);
  CHECK_THAT(in_root("sh -c 'mountpoint " + root.string() + "'"), Contains("is a mountpoint"));
  CHECK_THAT(in_root("sh -c 'ls " + checkout + "'"), Contains("build-asan") && Contains("tools"));
  CHECK(in_root("sh -c 'ls " + checkout + "/build; touch " + checkout + "/build/mine'").empty());
  CHECK(in_root("sh -c 'ls " + checkout + "/build'") == "mine\n");
  CHECK_FALSE(fs::exists(machine.root() / "build/mine"));
  CHECK(fs::is_empty(checkout));
  CHECK(fs::is_empty(root / "proc"));
  CHECK(machine.on("debian13 sh -c 'exit 8'").exit_code == 8);
}

TEST_CASE("nothing runs on when a command in a root is interrupted or killed", "[needs-mounts]") {
  if (!own_mounts()) return;
  const Machine machine;
  REQUIRE(machine.on("debian13 true").exit_code == 0);
  const fs::path started = machine.root() / "started";
  const std::string nap = "sleep 4321." + std::to_string(getpid());
  for (const int signal : {SIGINT, SIGTERM, SIGKILL}) {
    INFO(signal);
    fs::remove(started);
    // The first process has left the terminal's process group, as daemons do. The second is no shell any more when the
    // signal comes: dash may lose one that comes while it starts a command.
    Command command({"/bin/bash", "-c",
                     machine.command("debian13 sh -c 'setsid sh -c \"sleep 1; touch " + started.string() + "; exec " +
                                     nap + "\" & exec " + nap + "'")});
    while (!fs::exists(started) && command.running()) std::this_thread::sleep_for(std::chrono::milliseconds(20));
    REQUIRE(fs::exists(started));
    if (signal == SIGINT)
      kill(-command.pid(), signal);  // as the terminal does
    else
      command.send(signal);
    CHECK(command.wait().exit_code != 0);
    CHECK(all_gone(nap));
  }
}
