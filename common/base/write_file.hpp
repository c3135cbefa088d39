#pragma once

#include <sys/types.h>

#include <filesystem>
#include <string_view>

#include "common/base/descriptor.hpp"

namespace aloft {

/// A file written in parts, atomically: even after a power failure it is either complete or as it was before. The bytes
/// go to FILE.part; commit() syncs that, renames it to FILE, and syncs the folder. Without commit() nothing is left.
/// `mode` are the permissions, less those of the umask. Everything throws InputError "cannot write 'FILE': why". One
/// writer at a time.
class FileDraft {
 public:
  explicit FileDraft(std::filesystem::path file, mode_t mode = 0666);
  ~FileDraft();
  FileDraft(const FileDraft&) = delete;
  FileDraft& operator=(const FileDraft&) = delete;

  void write(std::string_view content);
  void commit();

 private:
  [[noreturn]] void fail() const;

  std::filesystem::path file_;
  std::filesystem::path draft_;
  Descriptor descriptor_;
};

/// The same with all content at once.
void write_file(const std::filesystem::path& file, std::string_view content, mode_t mode = 0666);

}  // namespace aloft
