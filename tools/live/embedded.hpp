#pragma once

#include <string_view>

namespace aloft::live {

/// The files of the page; empty if the program was built without it.
[[nodiscard]] std::string_view embedded_html();
[[nodiscard]] std::string_view embedded_script();
[[nodiscard]] std::string_view embedded_style();

}  // namespace aloft::live
