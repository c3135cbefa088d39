#pragma once

#include <cstddef>
#include <filesystem>
#include <string_view>

namespace aloft::report {

/// Throws InputError if the program `node` is not on the PATH; `what` is the option that needs it.
void require_node(std::string_view what);

/// Lets Node draw every chart of a written report into `folder` (made if missing), one SVG file each; returns how many.
/// InputError if the folder cannot be made, std::runtime_error with Node's message if it fails.
std::size_t render_svgs(const std::filesystem::path& page, const std::filesystem::path& folder);

}  // namespace aloft::report
