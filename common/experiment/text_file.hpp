#pragma once

#include <filesystem>
#include <string_view>

namespace aloft::experiment {

/// Writes a file that is either complete or not there, whatever happens meanwhile (temporary file, fsync, rename).
/// Throws InputError that says why it cannot be written.
void write_text_file(const std::filesystem::path& file, std::string_view text);

}  // namespace aloft::experiment
