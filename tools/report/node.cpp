#include "tools/report/node.hpp"

#include <fmt/format.h>

#include <fstream>
#include <stdexcept>
#include <string>

#include "common/base/error.hpp"
#include "tools/report/embedded.hpp"
#include "tools/report/program.hpp"

namespace aloft::report {
namespace {

namespace fs = std::filesystem;

constexpr std::chrono::seconds drawing_limit{600};

}  // namespace

void require_node(std::string_view what) {
  if (!find_program("node").empty()) return;
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
  std::ofstream(script, std::ios::binary) << embedded_svg_script();
  const Ended ended = run_program(find_program("node"), {script, page, folder}, drawing_limit);
  if (ended.code != 0)
    throw std::runtime_error(
        fmt::format("node could not draw the charts of {} (exit code {}): {}", page.string(), ended.code, ended.err));
  return std::stoul(ended.out);
}

}  // namespace aloft::report
