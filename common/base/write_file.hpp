#pragma once

#include <sys/types.h>

#include <filesystem>
#include <string_view>

namespace aloft {

/// Writes a file atomically: even after a power failure it is either complete or as it was before. The bytes go to
/// FILE.part and are synced, then that is renamed to FILE, and the folder is synced. One writer at a time.
/// `mode` are the permissions, less those of the umask. Throws InputError "cannot write 'FILE': why".
void write_file(const std::filesystem::path& file, std::string_view content, mode_t mode = 0666);

}  // namespace aloft
