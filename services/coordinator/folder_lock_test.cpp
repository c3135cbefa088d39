#include "services/coordinator/folder_lock.hpp"

#include <stdlib.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <catch2/catch.hpp>
#include <csignal>
#include <fstream>
#include <memory>
#include <stdexcept>

#include "common/base/error.hpp"

using namespace aloft;
using namespace aloft::coordinator;
using namespace std::chrono_literals;
using Catch::Contains;
namespace fs = std::filesystem;

namespace {

class Folder {
 public:
  Folder() {
    std::string pattern = (fs::temp_directory_path() / "aloft-lock-test-XXXXXX").string();
    if (mkdtemp(pattern.data()) == nullptr) throw std::runtime_error("cannot make a scratch folder");
    path_ = pattern;
  }
  ~Folder() { fs::remove_all(path_); }
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;
  [[nodiscard]] fs::path operator/(const char* name) const { return path_ / name; }

 private:
  fs::path path_;
};

const ProcessName alpha{7, "alpha", 5217, 1'795'355'110};
const ProcessName beta{8, "alpha", 34, 1'795'355'111};
const ProcessName far{9, "gamma", 2, 1'795'355'112};
const LockPatience none{0ms, 0ms};

}  // namespace

TEST_CASE("a folder has one coordinator, and the second one's error names it") {
  const Folder folder;
  {
    const FolderLock first(folder / "out", alpha, none);
    CHECK_THROWS_WITH(
        FolderLock(folder / "out", beta, {30ms, 1h}),
        Contains("has a coordinator already: aloft-coordinator on host alpha (process 5217, since 2026-"));
    CHECK_NOTHROW(FolderLock(folder / "other", beta, none));
  }
  CHECK_FALSE(fs::exists(folder / "out"));  // the lock had made it, and it stayed empty
  CHECK_NOTHROW(FolderLock(folder / "out", beta, none));
}

TEST_CASE("a lock that is no file names no holder, and delays no coordinator") {
  const Folder folder;
  fs::create_directory(folder / "out");
  REQUIRE(mkfifo((folder / "out" / "coordinator.lock").c_str(), 0600) == 0);
  const FolderLock first(folder / "out", alpha, none);
  CHECK_THROWS_WITH(FolderLock(folder / "out", beta, none), Contains("has a coordinator already: another process;"));
}

TEST_CASE("a lock leaves nothing of its own in a folder with results") {
  const Folder folder;
  fs::create_directories(folder / "out");
  std::ofstream(folder / "out" / "results.sqlite").put('x');
  { const FolderLock lock(folder / "out", alpha, none); }
  CHECK(fs::exists(folder / "out" / "results.sqlite"));
  CHECK_FALSE(fs::exists(folder / "out" / "coordinator.lock"));
}

TEST_CASE("the lock of a dead coordinator on another machine is waited for") {
  const Folder folder;
  auto first = std::make_unique<FolderLock>(folder / "out", alpha, none);
  CHECK_THROWS_WITH(FolderLock(folder / "out", far, {0ms, 60ms}), Contains("on host alpha (process 5217"));
  CHECK_THROWS_AS(FolderLock(folder / "out", far, {0ms, 1h}, [] { return true; }), InputError);
  int asked = 0;
  CHECK_NOTHROW(FolderLock(folder / "out", far, {0ms, 1h}, [&] {
    if (++asked == 3) first.reset();
    return false;
  }));
  CHECK(asked == 3);
}

TEST_CASE("a coordinator that was killed leaves no lock behind") {
  const Folder folder;
  int ready[2];
  REQUIRE(pipe(ready) == 0);
  const pid_t child = fork();
  if (child == 0) {
    const FolderLock lock(folder / "out", alpha, none);
    (void)!write(ready[1], "y", 1);
    pause();
  }
  char locked = 0;
  REQUIRE(read(ready[0], &locked, 1) == 1);
  CHECK_THROWS_AS(FolderLock(folder / "out", beta, none), InputError);
  kill(child, SIGKILL);
  waitpid(child, nullptr, 0);
  CHECK(fs::exists(folder / "out" / "coordinator.lock"));
  CHECK_NOTHROW(FolderLock(folder / "out", beta, none));
}
