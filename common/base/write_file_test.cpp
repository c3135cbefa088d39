#include "common/base/write_file.hpp"

#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <catch2/catch.hpp>
#include <csignal>
#include <cstdlib>
#include <fstream>
#include <functional>
#include <string>
#include <thread>

#include "common/base/error.hpp"
#include "common/base/read_file.hpp"

namespace fs = std::filesystem;
using aloft::read_file;
using aloft::write_file;
using Catch::Contains;

namespace {

/// If set, calls of fsync in this program run this function instead of the C library's.
std::function<int(int)>& fsync_instead() {
  static std::function<int(int)> instead;
  return instead;
}

struct OutputFolder {
  fs::path path = fs::temp_directory_path() / ("aloft-write-file-test-" + std::to_string(::getpid()));
  fs::path file = path / "file";
  OutputFolder() { fs::create_directories(path); }
  ~OutputFolder() {
    fsync_instead() = nullptr;
    fs::remove_all(path);
  }
  OutputFolder(const OutputFolder&) = delete;
  OutputFolder& operator=(const OutputFolder&) = delete;
  [[nodiscard]] std::size_t files() const {
    return static_cast<std::size_t>(std::distance(fs::directory_iterator(path), fs::directory_iterator()));
  }
};

fs::perms mode_of(const fs::path& file) {
  return fs::status(file).permissions();
}

}  // namespace

extern "C" int fsync(int fd) {
  return fsync_instead() ? fsync_instead()(fd) : static_cast<int>(::syscall(SYS_fsync, fd));
}

TEST_CASE("a file is written whole, with its permissions, and nothing is left beside it") {
  const OutputFolder folder;
  const std::string content = std::string("a\0b", 3) + std::string(300'000, 'x');
  write_file(folder.file, content);
  CHECK(read_file(folder.file) == content);
  write_file(folder.file, "short", 0600);
  CHECK(read_file(folder.file) == "short");
  CHECK(mode_of(folder.file) == (fs::perms::owner_read | fs::perms::owner_write));
  CHECK(folder.files() == 1);
}

TEST_CASE("a file written in parts is there once it is committed, and leaves nothing if it is given up") {
  const OutputFolder folder;
  write_file(folder.file, "old");
  {
    aloft::FileDraft given_up(folder.file);
    given_up.write("new");
  }
  CHECK(read_file(folder.file) == "old");
  CHECK(folder.files() == 1);
  aloft::FileDraft draft(folder.file);
  draft.write("one, ");
  draft.write("two");
  CHECK(read_file(folder.file) == "old");
  draft.commit();
  CHECK(read_file(folder.file) == "one, two");
  CHECK(folder.files() == 1);
}

TEST_CASE("a reader of a file that is being written finds the old or the new one") {
  const OutputFolder folder;
  const std::string old_content(200'000, 'o');
  const std::string new_content(300'000, 'n');
  write_file(folder.file, old_content);
  bool whole = true;
  {
    const std::jthread reader([&](const std::stop_token& stop) {
      while (!stop.stop_requested()) {
        const std::string content = read_file(folder.file);
        whole = whole && (content == old_content || content == new_content);
      }
    });
    for (int i = 0; i < 50; ++i) write_file(folder.file, i % 2 == 0 ? new_content : old_content);
  }
  CHECK(whole);
}

TEST_CASE("the bytes are synced before the rename, and the folder after it") {
  const OutputFolder folder;
  std::string order;
  fsync_instead() = [&](int fd) {
    struct stat facts {};
    REQUIRE(::fstat(fd, &facts) == 0);
    if (S_ISDIR(facts.st_mode)) order += fs::exists(folder.file) ? "name" : "no name yet";
    if (S_ISREG(facts.st_mode)) order += facts.st_size == 7 && !fs::exists(folder.file) ? "bytes, " : "too late, ";
    return 0;
  };
  write_file(folder.file, "content");
  CHECK(order == "bytes, name");
}

TEST_CASE("a file that cannot be written stays as it was, and the error has the reason") {
  const OutputFolder folder;
  write_file(folder.file, "old");
  SECTION("the disk is full") {
    rlimit before{};
    REQUIRE(::getrlimit(RLIMIT_FSIZE, &before) == 0);
    const rlimit little{1000, before.rlim_max};
    const auto handler = std::signal(SIGXFSZ, SIG_IGN);
    REQUIRE(::setrlimit(RLIMIT_FSIZE, &little) == 0);
    CHECK_THROWS_WITH(write_file(folder.file, std::string(2000, 'x')), Contains("file': File too large"));
    ::setrlimit(RLIMIT_FSIZE, &before);
    std::signal(SIGXFSZ, handler);
  }
  SECTION("fsync fails") {
    fsync_instead() = [](int) { return errno = EIO, -1; };
    CHECK_THROWS_WITH(write_file(folder.file, "new"), Contains("file': Input/output error"));
  }
  SECTION("there is no such folder") {
    CHECK_THROWS_AS(write_file(folder.path / "no" / "file", "new"), aloft::InputError);
    CHECK_THROWS_WITH(write_file(folder.path / "no" / "file", "new"), Contains("file': No such file or directory"));
  }
  CHECK(read_file(folder.file) == "old");
  CHECK(folder.files() == 1);
}

TEST_CASE("a leftover .part file exposes no secret, and its link is not followed") {
  const OutputFolder folder;
  const fs::path left = folder.file.string() + ".part";
  SECTION("a file for all to read") {
    std::ofstream(left) << "old";
  }
  SECTION("a link") {
    std::ofstream(folder.path / "other") << "other";
    fs::create_symlink(folder.path / "other", left);
  }
  write_file(folder.file, "secret", 0600);
  CHECK(read_file(folder.file) == "secret");
  CHECK(mode_of(folder.file) == (fs::perms::owner_read | fs::perms::owner_write));
  CHECK_FALSE(fs::exists(left));
  if (fs::exists(folder.path / "other")) CHECK(read_file(folder.path / "other") == "other");
}
