#include "common/base/write_file.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <system_error>
#include <utility>

#include "common/base/error.hpp"

namespace aloft {
namespace {

/// False on a failure, whose reason is then in errno.
bool sync_folder_of(const std::filesystem::path& file) {
  const std::filesystem::path parent = file.has_parent_path() ? file.parent_path() : ".";
  const Descriptor folder(::open(parent.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
  if (!folder.is_open()) return true;                    // a folder can be writable but not readable
  return ::fsync(folder.get()) == 0 || errno == EINVAL;  // EINVAL: the file system cannot
}

}  // namespace

FileDraft::FileDraft(std::filesystem::path file, mode_t mode)
    : file_(std::move(file)), draft_(file_.string() + ".part") {
  ::unlink(draft_.c_str());  // what a killed process left can be a link, or have other permissions
  descriptor_ = Descriptor(::open(draft_.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, mode));
  if (!descriptor_.is_open()) fail();
}

FileDraft::~FileDraft() {
  if (descriptor_.is_open()) ::unlink(draft_.c_str());
}

void FileDraft::write(std::string_view content) {
  while (!content.empty()) {
    const ssize_t count = ::write(descriptor_.get(), content.data(), content.size());
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) fail();
    content.remove_prefix(static_cast<std::size_t>(count));
  }
}

void FileDraft::commit() {
  if (::fsync(descriptor_.get()) != 0 || std::rename(draft_.c_str(), file_.c_str()) != 0 || !sync_folder_of(file_))
    fail();
  descriptor_ = Descriptor();
}

void FileDraft::fail() const {
  throw InputError("cannot write '{}': {}", file_.string(), std::generic_category().message(errno));
}

void write_file(const std::filesystem::path& file, std::string_view content, mode_t mode) {
  FileDraft draft(file, mode);
  draft.write(content);
  draft.commit();
}

}  // namespace aloft
