#pragma once

#include <sys/types.h>

#include <chrono>
#include <filesystem>
#include <string>
#include <vector>

namespace aloft::cli {

/// The processes that a run started on this machine. Each runs in a process group of its own, so that Ctrl-C reaches
/// only the parent, which then ends them in order.
class Children {
 public:
  struct Ended {
    std::string name;
    int exit_code = 0;  ///< -1 if a signal ended it
    int signal = 0;
    [[nodiscard]] std::string reason() const;
  };

  Children() = default;
  ~Children() { stop_all(std::chrono::milliseconds(0)); }
  Children(const Children&) = delete;
  Children& operator=(const Children&) = delete;

  /// Starts `arguments[0]`; its standard output and error are appended to `output`. Throws std::system_error.
  void start(const std::string& name, const std::vector<std::string>& arguments, const std::filesystem::path& output);
  /// Children that ended since the last call; never blocks.
  std::vector<Ended> reap();
  /// Sends SIGTERM to all, and SIGKILL to those that still run after `limit`. Returns the names of the killed.
  std::vector<std::string> stop_all(std::chrono::milliseconds limit);
  [[nodiscard]] bool empty() const noexcept { return children_.empty(); }

 private:
  struct Child {
    std::string name;
    pid_t pid;
  };
  std::vector<Child> children_;
};

}  // namespace aloft::cli
