#pragma once

#include <span>
#include <string>

#include "common/base/parameters.hpp"

namespace aloft::reference {

/// A line below the title that names the source of a page.
inline constexpr const char* made_by =
    "Made by `tools/reference.sh` from the tables that the programs go by; a test keeps it current.\n";

/// `text` as a cell of a table: bars in it do not end the cell.
[[nodiscard]] std::string cell(std::string text);

/// Name, default, allowed values and meaning of every entry; those named in `required` have no default.
[[nodiscard]] std::string parameter_table(std::span<const ParameterSpec> table,
                                          std::span<const std::string> required = {});

}  // namespace aloft::reference
