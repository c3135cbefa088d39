#pragma once

#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <string_view>

#include "tools/report/embedded.hpp"
#include "tools/report/report_data.hpp"

namespace aloft::report {

struct ReportOptions {
  std::filesystem::path page{};   ///< where the HTML file goes; empty: report.html in the result folder
  std::filesystem::path svg{};    ///< folder for one SVG file per chart; empty: none
  std::filesystem::path latex{};  ///< where tables for LaTeX go; empty: nowhere
  std::filesystem::path pdf{};    ///< where the printed page goes; empty: nowhere
  std::string chromium{};         ///< the browser that prints; empty: see require_chromium()
  Choice choice{};
};

struct WrittenReport {
  std::filesystem::path page;
  std::size_t missing_conditions = 0;  ///< conditions that are not finished
  std::size_t charts = 0;              ///< SVG files written
};

/// Whether this program was built with the charts.
[[nodiscard]] inline bool has_charts() {
  return !embedded_page().empty();
}

/// InputError if `page` is empty: this program was built without the charts (ALOFT_REPORT_CHARTS).
void require_charts(std::string_view page = embedded_page());

/// Writes the report on a result folder of `aloft run`, or on all result folders inside `dir` (`aloft reproduce`).
/// InputError if there are no charts or no results, the choice is not there, a file cannot be written, or SVG is asked
/// for without Node or PDF without Chromium; nothing is written then.
WrittenReport write_report(const std::filesystem::path& dir, const ReportOptions& options = {});

/// The finished page: `data` as report_data() gives it, inside the embedded template.
[[nodiscard]] std::string render_page(const nlohmann::json& data);

}  // namespace aloft::report
