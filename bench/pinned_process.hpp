#pragma once

#include <fcntl.h>
#include <signal.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <filesystem>
#include <stdexcept>
#include <string>
#include <vector>

namespace bench {

/// A process of a program from this one's folder, pinned to some cores. The destructor asks it to end, and waits.
class PinnedProcess {
 public:
  /// `cores` as taskset takes them, e.g. "0" or "0,1"; `log` is the file for its output.
  PinnedProcess(const std::string& cores, const std::string& program, const std::vector<std::string>& arguments,
                const std::string& log = "/dev/null") {
    const auto folder = std::filesystem::read_symlink("/proc/self/exe").parent_path();
    std::vector<std::string> words{"taskset", "-c", cores, (folder / program).string()};
    words.insert(words.end(), arguments.begin(), arguments.end());
    std::vector<char*> argv;
    argv.reserve(words.size() + 1);
    for (std::string& word : words) argv.push_back(word.data());
    argv.push_back(nullptr);
    posix_spawn_file_actions_t output;
    posix_spawn_file_actions_init(&output);
    posix_spawn_file_actions_addopen(&output, STDOUT_FILENO, "/dev/null", O_WRONLY, 0);
    posix_spawn_file_actions_addopen(&output, STDERR_FILENO, log.c_str(), O_WRONLY | O_CREAT | O_APPEND, 0600);
    const int error = posix_spawnp(&pid_, "taskset", &output, nullptr, argv.data(), environ);
    posix_spawn_file_actions_destroy(&output);
    if (error != 0) throw std::runtime_error("cannot start " + program);
  }
  ~PinnedProcess() {
    kill(pid_, SIGTERM);
    waitpid(pid_, nullptr, 0);
  }
  PinnedProcess(const PinnedProcess&) = delete;
  PinnedProcess& operator=(const PinnedProcess&) = delete;

  [[nodiscard]] pid_t pid() const noexcept { return pid_; }

 private:
  pid_t pid_ = 0;
};

}  // namespace bench
