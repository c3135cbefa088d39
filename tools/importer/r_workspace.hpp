#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace aloft::importer {

/// The numeric vectors of an R workspace, by name. A missing value (NA) is NaN.
using NumericVectors = std::map<std::string, std::vector<double>, std::less<>>;

/// Reads a workspace as R's save() writes it: XDR, compressed with gzip. Lists, texts and data frames are skipped.
/// Throws InputError if the file cannot be read, is not gzip, is cut short or holds no R workspace.
[[nodiscard]] NumericVectors read_r_workspace(const std::filesystem::path& file);

}  // namespace aloft::importer
