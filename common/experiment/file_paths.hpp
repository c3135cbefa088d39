#pragma once

#include <filesystem>
#include <nlohmann/json_fwd.hpp>

namespace aloft::experiment {

/// Makes relative paths in an experiment (measured flights, files that agents read, also those of a relay's crew) count
/// from `folder`, an absolute path. Ill-formed entries are left as they are; the checks that follow refuse them.
void anchor_paths(nlohmann::ordered_json& document, const std::filesystem::path& folder);

/// The absolute path of a file that an experiment names and that is to be read; a relative one counts from the working
/// directory. InputError if there is no such file; its message gives this rule.
[[nodiscard]] std::filesystem::path locate(const std::filesystem::path& given);

}  // namespace aloft::experiment
