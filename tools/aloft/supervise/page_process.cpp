#include "tools/aloft/supervise/page_process.hpp"

#include <fmt/format.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cstdlib>
#include <fstream>
#include <thread>

#include "common/base/read_file.hpp"
#include "services/runtime/bus_flags.hpp"
#include "services/runtime/plugin_flag.hpp"
#include "tools/aloft/supervise/processes.hpp"

namespace aloft::cli {
namespace {

constexpr std::chrono::milliseconds look_period{20};

std::vector<std::string> command(const std::filesystem::path& dir, const bus::BusOptions& place,
                                 const PageOptions& options) {
  std::vector<std::string> arguments{program_path("aloft").string(), "live", dir.string(), "--die-with-parent"};
  if (!place.run.empty())
    for (const std::string& argument : runtime::bus_arguments(place)) arguments.push_back(argument);
  for (const std::string& argument : runtime::plugin_arguments()) arguments.push_back(argument);
  if (options.with_control) arguments.emplace_back("--operator");
  return arguments;
}

bool on_desktop() {
  const auto is_set = [](const char* name) {
    const char* value = std::getenv(name);
    return value != nullptr && *value != '\0';
  };
  return isatty(STDOUT_FILENO) == 1 && (is_set("DISPLAY") || is_set("WAYLAND_DISPLAY"));
}

/// Leaves the browser to itself: it must not end with the run. Without xdg-open the user has the address.
void open_in_browser(std::string address) {
  std::string shell = "/bin/sh";
  std::string option = "-c";
  std::string script = "xdg-open \"$0\" </dev/null >/dev/null 2>&1 &";
  std::array<char*, 5> arguments{shell.data(), option.data(), script.data(), address.data(), nullptr};
  posix_spawnattr_t own_group{};
  posix_spawnattr_init(&own_group);
  posix_spawnattr_setflags(&own_group, POSIX_SPAWN_SETPGROUP);
  pid_t pid = 0;
  if (posix_spawn(&pid, shell.c_str(), nullptr, &own_group, arguments.data(), environ) == 0) waitpid(pid, nullptr, 0);
  posix_spawnattr_destroy(&own_group);
}

}  // namespace

PageProcess::PageProcess(const std::filesystem::path& dir, const bus::BusOptions& place, const PageOptions& options)
    : output_(dir / "log" / "aloft-live.err") {
  std::filesystem::create_directories(output_.parent_path());
  std::error_code missing;
  const std::uintmax_t size = std::filesystem::file_size(output_, missing);
  if (!missing) already_written_ = size;
  // The address may contain a token.
  std::ofstream(output_, std::ios::app).close();
  std::filesystem::permissions(output_, std::filesystem::perms::owner_read | std::filesystem::perms::owner_write);
  children_.start("aloft-live", command(dir, place, options), output_);
}

std::vector<std::string> PageProcess::news() {
  std::vector<std::string> lines;
  if (!told_ && std::filesystem::exists(output_)) {
    const std::string written = read_file(output_).substr(already_written_);
    const std::size_t begin = written.find("http://");
    const std::size_t end = written.find('\n', begin == std::string::npos ? 0 : begin);
    if (begin != std::string::npos && end != std::string::npos) {
      const std::string address = written.substr(begin, end - begin);
      lines.push_back("Watch it at " + address);
      if (on_desktop()) open_in_browser(address);
      told_ = true;
    }
  }
  for (const Children::Ended& ended : children_.reap())
    lines.push_back(fmt::format("the page for the browser has ended: {}; the run goes on; see {}", ended.reason(),
                                output_.string()));
  return lines;
}

std::vector<std::string> PageProcess::first_news(std::chrono::milliseconds limit) {
  const auto until = std::chrono::steady_clock::now() + limit;
  std::vector<std::string> lines;
  while (lines.empty() && std::chrono::steady_clock::now() < until) {
    std::this_thread::sleep_for(look_period);
    lines = news();
  }
  return lines;
}

}  // namespace aloft::cli
