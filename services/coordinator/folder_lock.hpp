#pragma once

#include <chrono>
#include <filesystem>
#include <string>

#include "common/base/process_name.hpp"

namespace aloft::coordinator {

/// One coordinator at a time works with a result folder. A file in the folder is locked and says who it is; it is gone
/// when the lock is given back, and free as soon as its process is dead.
class FolderLock {
 public:
  /// Waits so long for a coordinator that is just ending. InputError, naming the other one, if it stays; where files
  /// cannot be written or locked, nobody is refused.
  FolderLock(std::filesystem::path folder, const ProcessName& self, std::chrono::milliseconds patience);
  ~FolderLock();
  FolderLock(const FolderLock&) = delete;
  FolderLock& operator=(const FolderLock&) = delete;

 private:
  bool take();
  void write(const ProcessName& self) const;
  [[nodiscard]] std::string holder() const;

  std::filesystem::path folder_;
  std::filesystem::path file_;
  bool made_folder_ = false;
  int fd_ = -1;
};

}  // namespace aloft::coordinator
