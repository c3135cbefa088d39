#include "tests/integration/command.hpp"

#include <fcntl.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <catch2/catch.hpp>
#include <cstdlib>
#include <fstream>
#include <sstream>
#include <thread>

#include "tests/paths.hpp"

namespace aloft::test {
namespace {

[[noreturn]] void execute(const std::vector<std::string>& arguments, const std::filesystem::path& out,
                          const std::filesystem::path& err) {
  setpgid(0, 0);
  dup2(open("/dev/null", O_RDONLY), STDIN_FILENO);
  dup2(open(out.c_str(), O_WRONLY | O_CREAT, 0600), STDOUT_FILENO);
  dup2(open(err.c_str(), O_WRONLY | O_CREAT, 0600), STDERR_FILENO);
  if (chdir(source_dir().c_str()) != 0) _exit(126);
  std::vector<std::string> copies = arguments;
  if (!copies[0].starts_with('/')) copies[0] = (bin_dir() / copies[0]).string();
  std::vector<char*> argv;
  argv.reserve(copies.size() + 1);
  for (std::string& argument : copies) argv.push_back(argument.data());
  argv.push_back(nullptr);
  execv(argv[0], argv.data());
  _exit(127);
}

}  // namespace

ScratchDir::ScratchDir() {
  std::string pattern = (std::filesystem::temp_directory_path() / "aloft-test-XXXXXX").string();
  if (mkdtemp(pattern.data()) == nullptr) throw std::runtime_error("cannot make a scratch folder");
  path_ = pattern;
}

ScratchDir::~ScratchDir() {
  std::error_code ignored;
  std::filesystem::remove_all(path_, ignored);
}

void die_with(int parent) {
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  if (getppid() != parent) _exit(1);  // the parent ended before prctl
}

Command::Command(const std::vector<std::string>& arguments) {
  const int test = getpid();
  pid_ = fork();
  if (pid_ != 0) return;
  die_with(test);
  execute(arguments, scratch_ / "out", scratch_ / "err");
}

Command::~Command() {
  if (running()) {
    send(SIGKILL);
    waitpid(pid_, &status_, 0);
  }
}

void Command::send(int signal) const {
  kill(pid_, signal);
}

bool Command::running() {
  if (!reaped_) reaped_ = waitpid(pid_, &status_, WNOHANG) == pid_;
  return !reaped_;
}

Finished Command::wait(std::chrono::seconds limit) {
  limit *= slowdown;
  const auto deadline = std::chrono::steady_clock::now() + limit;
  while (running()) {
    if (std::chrono::steady_clock::now() > deadline) {
      send(SIGKILL);
      FAIL("still running after " << limit.count() << " s; it printed: " << error_so_far());
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  return {WIFEXITED(status_) ? WEXITSTATUS(status_) : -1, read_text(scratch_ / "out"), error_so_far()};
}

std::string Command::error_so_far() const {
  return read_text(scratch_ / "err");
}

Finished run_command(const std::vector<std::string>& arguments, std::chrono::seconds limit) {
  return Command(arguments).wait(limit);
}

std::string read_text(const std::filesystem::path& file) {
  std::ostringstream text;
  text << std::ifstream(file).rdbuf();
  return text.str();
}

void write_text(const std::filesystem::path& file, const std::string& text) {
  std::ofstream(file) << text;
}

std::vector<int> processes_with(const std::string& text) {
  std::vector<int> pids;
  for (const auto& entry : std::filesystem::directory_iterator("/proc")) {
    const std::string name = entry.path().filename().string();
    if (name.find_first_not_of("0123456789") != std::string::npos) continue;
    if (read_text(entry.path() / "cmdline").find(text) != std::string::npos) pids.push_back(std::stoi(name));
  }
  return pids;
}

std::string test_domain() {
  return std::to_string(10 + getpid() % 90);
}

}  // namespace aloft::test
