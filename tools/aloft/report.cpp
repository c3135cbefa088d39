#include "tools/report/report.hpp"

#include <fmt/format.h>

#include "common/base/error.hpp"
#include "tools/aloft/commands.hpp"

namespace aloft::cli {
namespace {

struct Options {
  std::filesystem::path dir;
  report::ReportOptions report;
};

int write(const Options& options) {
  const report::WrittenReport written = report::write_report(options.dir, options.report);
  if (written.missing_conditions > 0)
    fmt::print(stderr, "{} conditions are not finished; the report says what is missing\n", written.missing_conditions);
  if (written.charts > 0) fmt::print(stderr, "{} charts: {}\n", written.charts, options.report.svg.string());
  fmt::print("{}\n", written.page.string());
  for (const std::filesystem::path& file : {options.report.latex, options.report.pdf})
    if (!file.empty()) fmt::print("{}\n", file.string());
  return exit_ok;
}

}  // namespace

void add_report(CLI::App& app, Job& job) {
  auto* command = app.add_subcommand("report",
                                     "Write one self-contained HTML page: box plots, tables beside the published "
                                     "values, claims, one flight in detail");
  auto options = std::make_shared<Options>();
  command->add_option("dir", options->dir, "Result folder of 'aloft run', or a folder of such folders")->required();
  command->add_option("--out", options->report.page, "The HTML file [report.html in the result folder]");
  command->add_option("--svg", options->report.svg,
                      "Also write every chart as an SVG file into this folder (needs Node)");
  command->add_option("--latex", options->report.latex,
                      "Also write the tables as LaTeX (booktabs) into this file, to be read by \\input");
  command->add_option("--pdf", options->report.pdf, "Also print the page into this PDF file (needs Chromium)");
  command->add_option("--chromium", options->report.chromium,
                      "The Chromium or Chrome that prints [$CHROMIUM, or the first one on the PATH]");
  command->add_option("--condition", options->report.choice.condition,
                      "Condition whose flight the page opens with: its name or number [0]");
  command->add_option("--trial", options->report.choice.trial,
                      "Trial whose flights are shown [the first that all agents have flown]");
  command->callback([options, &job] { job = [options] { return write(*options); }; });
}

}  // namespace aloft::cli
