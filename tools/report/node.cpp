#include "tools/report/node.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <sstream>
#include <stdexcept>
#include <string>

#include "common/base/error.hpp"
#include "common/base/read_file.hpp"
#include "tools/report/embedded.hpp"

namespace aloft::report {
namespace {

namespace fs = std::filesystem;

/// A folder that disappears with this object.
class TemporaryFolder {
 public:
  TemporaryFolder() {
    std::string name = (fs::temp_directory_path() / "aloft-report-XXXXXX").string();
    if (mkdtemp(name.data()) == nullptr)
      throw InputError("{}: no folder can be made there; set TMPDIR to a writable folder",
                       fs::temp_directory_path().string());
    path_ = name;
  }
  ~TemporaryFolder() {
    std::error_code ignored;
    fs::remove_all(path_, ignored);
  }
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;
  [[nodiscard]] const fs::path& path() const { return path_; }

 private:
  fs::path path_;
};

/// Runs node with its output in files; returns the exit code, or -1 if a signal ended it.
int run_node(const std::string& script, const std::string& page, const std::string& folder, const std::string& out,
             const std::string& err) {
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_addopen(&actions, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
  posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, out.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600);
  posix_spawn_file_actions_addopen(&actions, STDERR_FILENO, err.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600);
  std::string arguments[] = {"node", script, page, folder};
  char* argv[] = {arguments[0].data(), arguments[1].data(), arguments[2].data(), arguments[3].data(), nullptr};
  pid_t pid = 0;
  const int error = posix_spawnp(&pid, "node", &actions, nullptr, argv, environ);
  posix_spawn_file_actions_destroy(&actions);
  if (error != 0) throw std::runtime_error(fmt::format("cannot start node: {}", std::strerror(error)));
  int status = 0;
  while (waitpid(pid, &status, 0) < 0 && errno == EINTR) {
  }
  return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

}  // namespace

void require_node(std::string_view what) {
  const char* path = std::getenv("PATH");
  std::istringstream folders(path == nullptr ? "" : path);
  for (std::string folder; std::getline(folders, folder, ':');)
    if (access((fs::path(folder) / "node").c_str(), X_OK) == 0) return;
  throw InputError(
      "{}: needs the program 'node', which is not on the PATH; install the package nodejs, or save single "
      "charts as SVG from the page",
      what);
}

std::size_t render_svgs(const std::filesystem::path& page, const std::filesystem::path& folder) {
  std::error_code error;
  fs::create_directories(folder, error);
  if (error) throw InputError("{}: cannot be made for the SVG files: {}", folder.string(), error.message());
  const TemporaryFolder scratch;
  const fs::path script = scratch.path() / "render_svg.cjs";
  const fs::path out = scratch.path() / "out";
  const fs::path err = scratch.path() / "err";
  std::ofstream(script, std::ios::binary) << embedded_svg_script();
  const int code = run_node(script, page, folder, out, err);
  if (code != 0)
    throw std::runtime_error(
        fmt::format("node could not draw the charts of {} (exit code {}): {}", page.string(), code, read_file(err)));
  return std::stoul(read_file(out));
}

}  // namespace aloft::report
