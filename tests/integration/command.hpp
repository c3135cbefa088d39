#pragma once

#include <chrono>
#include <filesystem>
#include <string>
#include <vector>

namespace aloft::test {

/// What a program printed and how it ended.
struct Finished {
  int exit_code = -1;  ///< -1: ended by a signal
  std::string out;
  std::string err;
};

/// A folder under the system's temporary folder that disappears with this object.
class ScratchDir {
 public:
  ScratchDir();
  ~ScratchDir();
  ScratchDir(const ScratchDir&) = delete;
  ScratchDir& operator=(const ScratchDir&) = delete;

  [[nodiscard]] std::filesystem::path path() const { return path_; }
  [[nodiscard]] std::filesystem::path operator/(const std::string& name) const { return path_ / name; }

 private:
  std::filesystem::path path_;
};

/// Factor for the limits of waits, because programs are slower under a sanitizer.
#if defined(__SANITIZE_THREAD__)
inline constexpr int slowdown = 10;
#elif defined(__SANITIZE_ADDRESS__)
inline constexpr int slowdown = 4;
#else
inline constexpr int slowdown = 1;
#endif

/// Called by a child process just after fork(): it is killed when its test, the process `parent`, ends in any way.
void die_with(int parent);

/// A program of build/bin (or an absolute path) started in the repository's root, in its own process group. It
/// does not survive the test.
class Command {
 public:
  explicit Command(const std::vector<std::string>& arguments);
  ~Command();
  Command(const Command&) = delete;
  Command& operator=(const Command&) = delete;

  void send(int signal) const;
  [[nodiscard]] bool running();
  /// Fails the test if the program has not ended within `limit` (times the slowdown); kills it first.
  Finished wait(std::chrono::seconds limit = std::chrono::seconds(60));
  [[nodiscard]] int pid() const noexcept { return pid_; }
  /// What it has printed on standard error so far.
  [[nodiscard]] std::string error_so_far() const;

 private:
  ScratchDir scratch_;
  int pid_ = 0;
  int status_ = 0;
  bool reaped_ = false;
};

/// Starts and waits.
Finished run_command(const std::vector<std::string>& arguments, std::chrono::seconds limit = std::chrono::seconds(60));

[[nodiscard]] std::string read_text(const std::filesystem::path& file);
void write_text(const std::filesystem::path& file, const std::string& text);

/// Processes whose command line contains `text`, by pid.
[[nodiscard]] std::vector<int> processes_with(const std::string& text);

/// A DDS domain for this test process: tests that run side by side use different ones.
[[nodiscard]] std::string test_domain();

}  // namespace aloft::test
