#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <string_view>

namespace aloft::report {

/// The text with what LaTeX takes for commands escaped.
[[nodiscard]] std::string latex_text(std::string_view text);

/// The tables of a report (`data` of report_data()), one per condition, to be read by \input; needs the package
/// booktabs.
[[nodiscard]] std::string latex_tables(const nlohmann::json& data);

}  // namespace aloft::report
