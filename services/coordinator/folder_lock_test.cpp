#include "services/coordinator/folder_lock.hpp"

#include <stdlib.h>
#include <sys/wait.h>
#include <unistd.h>

#include <catch2/catch.hpp>
#include <csignal>
#include <fstream>
#include <stdexcept>

#include "common/base/error.hpp"

using namespace aloft;
using namespace aloft::coordinator;
using namespace std::chrono_literals;
using Catch::Matchers::Contains;
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
const ProcessName beta{8, "beta", 34, 1'795'355'111};

}  // namespace

TEST_CASE("a folder has one coordinator, and the second is told who it is") {
  const Folder folder;
  {
    const FolderLock first(folder / "out", alpha, 0ms);
    CHECK_THROWS_WITH(
        FolderLock(folder / "out", beta, 30ms),
        Contains("has a coordinator already: aloft-coordinator on host alpha (process 5217, since 2026-"));
    CHECK_NOTHROW(FolderLock(folder / "other", beta, 0ms));
  }
  CHECK_FALSE(fs::exists(folder / "out"));  // which the lock had made, and nobody used
  CHECK_NOTHROW(FolderLock(folder / "out", beta, 0ms));
}

TEST_CASE("a lock leaves nothing of its own in a folder with results") {
  const Folder folder;
  fs::create_directories(folder / "out");
  std::ofstream(folder / "out" / "results.sqlite").put('x');
  { const FolderLock lock(folder / "out", alpha, 0ms); }
  CHECK(fs::exists(folder / "out" / "results.sqlite"));
  CHECK_FALSE(fs::exists(folder / "out" / "coordinator.lock"));
}

TEST_CASE("a coordinator that was killed locks nobody out") {
  const Folder folder;
  int ready[2];
  REQUIRE(pipe(ready) == 0);
  const pid_t child = fork();
  if (child == 0) {
    const FolderLock lock(folder / "out", alpha, 0ms);
    (void)!write(ready[1], "y", 1);
    pause();
  }
  char locked = 0;
  REQUIRE(read(ready[0], &locked, 1) == 1);
  CHECK_THROWS_AS(FolderLock(folder / "out", beta, 0ms), InputError);
  kill(child, SIGKILL);
  waitpid(child, nullptr, 0);
  CHECK(fs::exists(folder / "out" / "coordinator.lock"));
  CHECK_NOTHROW(FolderLock(folder / "out", beta, 0ms));
}
