#include "tools/report/pdf.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <cstdlib>
#include <stdexcept>
#include <vector>

#include "common/base/error.hpp"
#include "common/base/read_file.hpp"
#include "common/base/write_file.hpp"
#include "tools/report/program.hpp"

namespace aloft::report {
namespace {

namespace fs = std::filesystem;

constexpr std::chrono::seconds printing_limit{600};

/// As a file: address; everything but letters, digits and a few signs is escaped (RFC 3986).
std::string address_of(const fs::path& file) {
  std::string address = "file://";
  for (const char c : fs::absolute(file).string()) {
    const bool plain =
        std::isalnum(static_cast<unsigned char>(c)) != 0 || std::string_view("/-._~").find(c) != std::string_view::npos;
    address += plain ? std::string(1, c) : fmt::format("%{:02X}", static_cast<unsigned char>(c));
  }
  return address;
}

}  // namespace

std::filesystem::path require_chromium(const std::string& wanted) {
  const char* from_environment = std::getenv("CHROMIUM");
  const std::string named = !wanted.empty() || from_environment == nullptr ? wanted : from_environment;
  if (!named.empty()) {
    fs::path program = find_program(named);
    if (!program.empty()) return program;
    throw InputError("{}: there is no program '{}' that can be run; give the path of Chromium or Chrome",
                     wanted.empty() ? "CHROMIUM" : "--chromium", named);
  }
  for (const char* name : {"chromium", "chromium-browser", "google-chrome", "chrome"})
    if (fs::path program = find_program(name); !program.empty()) return program;
  throw InputError(
      "--pdf: needs Chromium or Chrome, and none is on the PATH; install the package chromium, or name the program "
      "with "
      "--chromium or the environment variable CHROMIUM");
}

void print_pdf(const std::filesystem::path& chromium, const std::filesystem::path& page,
               const std::filesystem::path& pdf) {
  const TemporaryFolder scratch;
  const fs::path printed = scratch.path() / "report.pdf";
  std::vector<std::string> arguments{
      "--headless",
      "--disable-gpu",
      "--no-first-run",
      "--disable-extensions",
      "--disable-background-networking",
      "--window-size=1040,800",        // as wide as the printed page, so that charts keep their size
      "--virtual-time-budget=600000",  // of the page's own time: until all charts are drawn
      "--no-pdf-header-footer",
      "--user-data-dir=" + (scratch.path() / "profile").string(),
      "--print-to-pdf=" + printed.string()};
  if (geteuid() == 0) arguments.emplace_back("--no-sandbox");  // Chromium refuses to be root's otherwise
  arguments.push_back(address_of(page) + "#theme=light");
  const Ended ended = run_program(chromium, std::move(arguments), printing_limit);
  const std::string bytes = fs::exists(printed) ? read_file(printed) : std::string();
  if (ended.code != 0 || !bytes.starts_with("%PDF"))
    throw std::runtime_error(fmt::format("{} could not print {} (exit code {}): {}", chromium.string(), page.string(),
                                         ended.code, ended.err));
  write_file(pdf, bytes);
}

}  // namespace aloft::report
