#pragma once

#include <chrono>
#include <filesystem>
#include <functional>
#include <string>

#include "common/base/descriptor.hpp"
#include "common/base/process_name.hpp"

namespace aloft::coordinator {

/// How long a coordinator waits for another one to give a folder back.
struct LockPatience {
  std::chrono::milliseconds here{2'000};  ///< a process of this machine that is just ending
  /// A process of another machine: a network file system notices only after a while that it has died.
  std::chrono::milliseconds elsewhere{120'000};
};

/// One coordinator at a time works with a result folder. It locks a file in the folder that names it; the file is
/// removed when the lock is given back, and the lock is free as soon as the process is dead.
class FolderLock {
 public:
  /// Waits for another coordinator that is ending, but not beyond `stopped`. InputError, naming the other one, if it
  /// stays. Where files cannot be written or locked, every coordinator gets the lock.
  FolderLock(
      std::filesystem::path folder, const ProcessName& self, const LockPatience& patience = {},
      const std::function<bool()>& stopped = [] { return false; });
  ~FolderLock();

 private:
  bool take();
  void write(const ProcessName& self) const;
  [[nodiscard]] std::string holder() const;

  std::filesystem::path folder_;
  std::filesystem::path file_;
  bool made_folder_ = false;
  Descriptor fd_;
};

}  // namespace aloft::coordinator
