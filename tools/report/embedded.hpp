#pragma once

#include <string_view>

namespace aloft::report {

/// Files embedded in the program.
[[nodiscard]] std::string_view embedded_page();        ///< the report page; its data block is still "%DATA%"
[[nodiscard]] std::string_view embedded_svg_script();  ///< render_svg.cjs
[[nodiscard]] std::string_view embedded_published();   ///< data/published.json

}  // namespace aloft::report
