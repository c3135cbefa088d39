#include "tools/aloft/supervise/children.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <signal.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstring>
#include <system_error>
#include <thread>

namespace aloft::cli {
namespace {

/// File actions and attributes of one posix_spawn.
struct SpawnSettings {
  posix_spawn_file_actions_t actions{};
  posix_spawnattr_t attributes{};

  explicit SpawnSettings(const std::string& output) {
    posix_spawn_file_actions_init(&actions);
    posix_spawn_file_actions_addopen(&actions, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
    posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, output.c_str(), O_WRONLY | O_CREAT | O_APPEND, 0644);
    posix_spawn_file_actions_adddup2(&actions, STDOUT_FILENO, STDERR_FILENO);
    posix_spawnattr_init(&attributes);
    sigset_t none;
    sigemptyset(&none);
    posix_spawnattr_setsigmask(&attributes, &none);
    posix_spawnattr_setpgroup(&attributes, 0);
    posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETPGROUP | POSIX_SPAWN_SETSIGMASK);
  }
  ~SpawnSettings() {
    posix_spawn_file_actions_destroy(&actions);
    posix_spawnattr_destroy(&attributes);
  }
  SpawnSettings(const SpawnSettings&) = delete;
  SpawnSettings& operator=(const SpawnSettings&) = delete;
};

}  // namespace

std::string Children::Ended::reason() const {
  if (signal != 0) return fmt::format("{} was ended by signal {} ({})", name, signal, strsignal(signal));
  return fmt::format("{} ended with exit code {}", name, exit_code);
}

void Children::start(const std::string& name, const std::vector<std::string>& arguments,
                     const std::filesystem::path& output) {
  const SpawnSettings settings(output.string());
  std::vector<std::string> copies = arguments;
  std::vector<char*> argv;
  argv.reserve(copies.size() + 1);
  for (std::string& argument : copies) argv.push_back(argument.data());
  argv.push_back(nullptr);
  pid_t pid = 0;
  const int error = posix_spawn(&pid, argv[0], &settings.actions, &settings.attributes, argv.data(), environ);
  if (error != 0)
    throw std::system_error(error, std::generic_category(), fmt::format("cannot start {}", arguments.front()));
  children_.push_back({name, pid});
}

std::vector<Children::Ended> Children::reap() {
  std::vector<Ended> ended;
  std::erase_if(children_, [&](const Child& child) {
    int status = 0;
    if (waitpid(child.pid, &status, WNOHANG) != child.pid) return false;
    ended.push_back(
        {child.name, WIFEXITED(status) ? WEXITSTATUS(status) : -1, WIFSIGNALED(status) ? WTERMSIG(status) : 0});
    return true;
  });
  return ended;
}

std::vector<std::string> Children::stop_all(std::chrono::milliseconds limit) {
  const auto deadline = std::chrono::steady_clock::now() + limit;
  for (const Child& child : children_) kill(child.pid, SIGTERM);
  while (!children_.empty() && std::chrono::steady_clock::now() < deadline) {
    reap();
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  std::vector<std::string> killed;
  for (const Child& child : children_) {
    killed.push_back(child.name);
    kill(child.pid, SIGKILL);
    waitpid(child.pid, nullptr, 0);
  }
  children_.clear();
  return killed;
}

}  // namespace aloft::cli
