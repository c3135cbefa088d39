#pragma once

#include <chrono>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

/// Programs that the report lets work for it.
namespace aloft::report {

/// A folder that disappears with this object.
class TemporaryFolder {
 public:
  /// InputError if there is no room for temporary files.
  TemporaryFolder();
  ~TemporaryFolder();
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;
  [[nodiscard]] const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

/// Where this program is: itself if it has a slash and can be run, else in a folder of the PATH; empty if nowhere.
[[nodiscard]] std::filesystem::path find_program(const std::string& name);

/// What a program printed, and its exit code; -1 if a signal ended it, also that of the time limit.
struct Ended {
  int code = 0;
  std::string out;
  std::string err;
};

/// Runs a program to its end, or kills it after `limit`. std::runtime_error if it cannot be started.
Ended run_program(const std::filesystem::path& program, std::vector<std::string> arguments, std::chrono::seconds limit);

}  // namespace aloft::report
