#pragma once

#include <sys/types.h>

#include <filesystem>
#include <string_view>

namespace aloft {

/// Writes a file that is either complete or as it was before, whatever happens meanwhile, a power failure included: the
/// bytes go to FILE.part, reach the disk, and take the name FILE, which reaches the disk too. One writer at a time.
/// `mode` are the permissions, less those of the umask. Throws InputError "cannot write 'FILE': why".
void write_file(const std::filesystem::path& file, std::string_view content, mode_t mode = 0666);

}  // namespace aloft
