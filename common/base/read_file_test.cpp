#include "common/base/read_file.hpp"

#include <sys/stat.h>
#include <unistd.h>

#include <catch2/catch.hpp>
#include <fstream>

#include "common/base/error.hpp"

using aloft::read_file;
using Catch::Contains;

namespace {

struct Folder {
  std::filesystem::path path =
      std::filesystem::temp_directory_path() / ("aloft-read-file-test-" + std::to_string(::getpid()));
  Folder() { std::filesystem::create_directories(path); }
  ~Folder() { std::filesystem::remove_all(path); }
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;
};

std::string refusal(const std::filesystem::path& file, std::uint64_t largest_bytes = aloft::largest_file_bytes) {
  try {
    (void)read_file(file, largest_bytes);
  } catch (const aloft::InputError& error) {
    return error.what();
  }
  return "";
}

}  // namespace

TEST_CASE("a file is read whole, up to its largest size, also through a link") {
  const Folder folder;
  std::string content(200'000, 'x');
  content[1] = '\0';
  std::ofstream(folder.path / "file", std::ios::binary) << content;
  CHECK(read_file(folder.path / "file") == content);
  CHECK(read_file(folder.path / "file", 200'000) == content);
  CHECK_THAT(refusal(folder.path / "file", 199'999), Contains("file'") && Contains("more than 199999 bytes"));
  std::filesystem::create_symlink(folder.path / "file", folder.path / "link");
  CHECK(read_file(folder.path / "link") == content);
  CHECK(!read_file("/proc/self/status").empty());  // its reported size is 0
}

TEST_CASE("a path that is not a regular file is refused without waiting") {
  const Folder folder;
  CHECK_THAT(refusal(folder.path / "nothing"), Contains("nothing': No such file"));
  CHECK_THAT(refusal(folder.path), Contains("is a folder, not a file"));
  REQUIRE(::mkfifo((folder.path / "pipe").c_str(), 0600) == 0);
  CHECK_THAT(refusal(folder.path / "pipe"), Contains("is a pipe, not a file"));
  CHECK_THAT(refusal("/dev/zero"), Contains("is a device, not a file"));
}
