#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

namespace aloft {

/// The largest file that is read unless the caller sets another limit.
inline constexpr std::uint64_t largest_file_bytes = std::uint64_t{256} << 20U;

/// All bytes of a regular file. Throws InputError "cannot read 'FILE': why" if it cannot be opened, has more than
/// `largest_bytes`, or is a folder, a pipe or a device: reading from the last two might never end.
[[nodiscard]] std::string read_file(const std::filesystem::path& file,
                                    std::uint64_t largest_bytes = largest_file_bytes);

}  // namespace aloft
