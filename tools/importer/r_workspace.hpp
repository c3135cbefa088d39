#pragma once

#include <filesystem>
#include <string>

#include "tools/importer/r_objects.hpp"

namespace aloft::importer {

/// Reads a workspace as R's save() writes it: XDR, compressed with gzip. Lists, texts and data frames are skipped.
/// Throws InputError if the file cannot be read, is not gzip, is cut short or holds no R workspace.
[[nodiscard]] NumericVectors read_r_workspace(const std::filesystem::path& file);
/// The same from the bytes of such a file, which messages call `file`.
[[nodiscard]] NumericVectors parse_r_workspace(std::string packed, const std::filesystem::path& file);

}  // namespace aloft::importer
