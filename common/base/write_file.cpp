#include "common/base/write_file.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <system_error>

#include "common/base/descriptor.hpp"
#include "common/base/error.hpp"

namespace aloft {
namespace {

/// The next three functions return false on a failure and leave its reason in errno.
bool write_all(int fd, std::string_view content) {
  while (!content.empty()) {
    const ssize_t count = ::write(fd, content.data(), content.size());
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) return false;
    content.remove_prefix(static_cast<std::size_t>(count));
  }
  return true;
}

bool write_draft(const std::filesystem::path& draft, std::string_view content, mode_t mode) {
  ::unlink(draft.c_str());  // what a killed process left can be a link, or have other permissions
  const Descriptor descriptor(::open(draft.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, mode));
  return descriptor.is_open() && write_all(descriptor.get(), content) && ::fsync(descriptor.get()) == 0;
}

bool sync_folder_of(const std::filesystem::path& file) {
  const std::filesystem::path parent = file.has_parent_path() ? file.parent_path() : ".";
  const Descriptor folder(::open(parent.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
  if (!folder.is_open()) return true;                    // a folder can be writable but not readable
  return ::fsync(folder.get()) == 0 || errno == EINVAL;  // EINVAL: the file system cannot
}

}  // namespace

void write_file(const std::filesystem::path& file, std::string_view content, mode_t mode) {
  const std::filesystem::path draft = file.string() + ".part";
  if (write_draft(draft, content, mode) && std::rename(draft.c_str(), file.c_str()) == 0 && sync_folder_of(file))
    return;
  const int reason = errno;
  ::unlink(draft.c_str());
  throw InputError("cannot write '{}': {}", file.string(), std::generic_category().message(reason));
}

}  // namespace aloft
