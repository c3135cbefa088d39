#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "common/base/descriptor.hpp"
#include "common/base/error.hpp"

namespace aloft::store {

/// The result folder was deleted, moved or replaced while a process was writing into it. What is written from now on
/// can be lost, so writing must stop.
class ResultsGone : public FormattedError {
  using FormattedError::FormattedError;
};

/// Notices when a file of a result folder is no longer the same file as when the watch began.
class FolderWatch {
 public:
  /// Watches those of `names` in `dir` that are there now.
  FolderWatch(std::filesystem::path dir, const std::vector<std::string>& names);

  /// Throws ResultsGone, which names the file and what to do. From any thread.
  void check() const;

 private:
  struct File {
    std::filesystem::path path;
    Descriptor fd;  // keeps its inode from being given to another file
  };
  std::filesystem::path dir_;
  std::vector<File> files_;
};

/// The watch over DIR/results.sqlite, for a process that does not write into it but starts the writers.
[[nodiscard]] FolderWatch watch_results(const std::filesystem::path& dir);

/// What was created when a result folder was opened for writing.
struct MadeResults {
  std::filesystem::path dir;
  std::vector<std::filesystem::path> folders;  ///< outermost first
  bool database = false;
  bool log_is_new = false;  ///< there was no log folder before
};

/// Makes `dir` if it is not there. InputError if that cannot be done, or if it holds other files but no results.
[[nodiscard]] MadeResults make_folder(const std::filesystem::path& dir);

/// For a run that is refused after it made its result folder: removes what it made, logs included. Leaves everything
/// where it is if flights are stored, or if another process writes there.
void take_back(const MadeResults& made);

}  // namespace aloft::store
