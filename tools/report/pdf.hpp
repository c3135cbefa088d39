#pragma once

#include <filesystem>
#include <string>

namespace aloft::report {

/// The Chromium that prints: `wanted` if given, else $CHROMIUM, else chromium, chromium-browser, google-chrome or
/// chrome on the PATH. InputError if it is not there.
[[nodiscard]] std::filesystem::path require_chromium(const std::string& wanted);

/// Lets Chromium print a written report, whole or not at all. std::runtime_error with its message if it fails.
void print_pdf(const std::filesystem::path& chromium, const std::filesystem::path& page,
               const std::filesystem::path& pdf);

}  // namespace aloft::report
