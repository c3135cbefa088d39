#include "tools/report/report.hpp"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <vector>

#include "common/base/error.hpp"
#include "common/base/write_file.hpp"
#include "tools/report/latex.hpp"
#include "tools/report/node.hpp"
#include "tools/report/pdf.hpp"

namespace aloft::report {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view data_mark = "%DATA%";

/// Returns `dir` itself if it is a result folder, else the result folders in it, by name.
std::vector<fs::path> result_folders(const fs::path& dir) {
  if (!fs::is_directory(dir))
    throw InputError("{}: there is no such folder; give the result folder of an 'aloft run'", dir.string());
  const auto has_results = [](const fs::path& folder) { return fs::exists(folder / "results.sqlite"); };
  if (has_results(dir)) return {dir};
  std::vector<fs::path> folders;
  for (const auto& entry : fs::directory_iterator(dir))
    if (entry.is_directory() && has_results(entry.path())) folders.push_back(entry.path());
  std::ranges::sort(folders);
  if (folders.empty())
    throw InputError(
        "{}: neither this folder nor one inside it holds a results.sqlite; 'aloft run EXPERIMENT.json "
        "--out {}' makes one",
        dir.string(), dir.string());
  return folders;
}

void write_page(const fs::path& file, const std::string& text) {
  try {
    write_file(file, text);
  } catch (const InputError&) {
    throw InputError("{}: cannot be written; check that the folder exists, is writable and has room, or use --out",
                     file.string());
  }
}

/// Known before anything is written.
void require_folder_of(const fs::path& file, std::string_view option) {
  if (file.empty() || fs::is_directory(fs::absolute(file).parent_path())) return;
  throw InputError("{}: there is no folder {}; make it, or choose another file", option,
                   fs::absolute(file).parent_path().string());
}

}  // namespace

void require_charts(std::string_view page) {
  if (page.empty())
    throw InputError(
        "this aloft was built without the charts of its report; in its checkout, tools/setup.sh adds them (and node, "
        "npm and esbuild, which bundle them)");
}

std::string render_page(const nlohmann::json& data) {
  // "<" inside a script element could end it; the escaped form is the same JSON.
  std::string text;
  for (const char c : data.dump()) c == '<' ? text += "\\u003c" : text += c;
  const std::string_view page = embedded_page();
  const std::size_t mark = page.find(data_mark);
  return std::string(page.substr(0, mark)) + text + std::string(page.substr(mark + data_mark.size()));
}

WrittenReport write_report(const std::filesystem::path& dir, const ReportOptions& options) {
  require_charts();
  const std::vector<fs::path> folders = result_folders(dir);
  if (!options.svg.empty()) require_node("--svg");
  const fs::path chromium = options.pdf.empty() ? fs::path() : require_chromium(options.chromium);
  require_folder_of(options.latex, "--latex");
  require_folder_of(options.pdf, "--pdf");
  std::vector<store::ResultStore> runs;
  runs.reserve(folders.size());
  for (const fs::path& folder : folders) runs.push_back(store::ResultStore::open_for_reading(folder));
  const nlohmann::json data = report_data(runs, options.choice);
  WrittenReport written{options.page.empty() ? dir / "report.html" : options.page, data["missing"].size(), 0};
  write_page(written.page, render_page(data));
  if (!options.svg.empty()) written.charts = render_svgs(written.page, options.svg);
  if (!options.latex.empty()) write_page(options.latex, latex_tables(data));
  if (!options.pdf.empty()) print_pdf(chromium, written.page, options.pdf);
  return written;
}

}  // namespace aloft::report
