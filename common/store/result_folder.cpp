#include "common/store/result_folder.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>

#include "common/store/database.hpp"
#include "common/store/result_store.hpp"

namespace aloft::store {
namespace {

/// Why the file at `path` is not the one behind `fd`; null if it is.
const char* change_of(const std::filesystem::path& path, int fd) {
  struct stat there {};
  struct stat ours {};
  if (::stat(path.c_str(), &there) != 0)
    return errno == ENOENT || errno == ENOTDIR || errno == ESTALE ? "is gone" : nullptr;
  if (::fstat(fd, &ours) != 0) return nullptr;
  return there.st_dev == ours.st_dev && there.st_ino == ours.st_ino ? nullptr : "is another file now";
}

/// A run must not start among other files: the folder could be the wrong one, or have lost its database.
void check_is_empty(const std::filesystem::path& dir) {
  for (const auto& entry : std::filesystem::directory_iterator(dir)) {
    const std::string name = entry.path().filename().string();
    if (name == log_folder || name == "lost+found" || name == coordinator_lock_name || name.starts_with(database_name))
      continue;
    if (std::filesystem::exists(dir / "experiment.json"))
      throw InputError(
          "'{}' has lost its {}: experiment.json is there without it. Put it back, or remove the folder to fly "
          "everything anew, or use another folder for --out",
          dir.string(), database_name);
    throw InputError("'{}' holds other files ('{}'), but no results; use an empty or new folder for --out",
                     dir.string(), name);
  }
}

}  // namespace

FolderWatch::FolderWatch(std::filesystem::path dir, const std::vector<std::string>& names) : dir_(std::move(dir)) {
  for (const std::string& name : names) {
    const std::filesystem::path path = dir_ / name;
    // O_PATH: closing an ordinary descriptor would drop the locks that SQLite holds on the file.
    if (Descriptor fd(::open(path.c_str(), O_PATH | O_CLOEXEC)); fd.is_open()) files_.push_back({path, std::move(fd)});
  }
}

void FolderWatch::check() const {
  for (const File& file : files_)
    if (const char* change = change_of(file.path, file.fd.get()))
      throw ResultsGone(
          "'{}' was deleted, moved or replaced while a run was storing flights there: {} {}. Nothing more is stored. "
          "If it was moved, move it back; then give the same command again: it goes on with what is there, or begins "
          "anew",
          dir_.string(), file.path.filename().string(), change);
}

FolderWatch watch_results(const std::filesystem::path& dir) {
  return {dir, {database_name}};
}

MadeResults make_folder(const std::filesystem::path& dir) {
  MadeResults made{dir, {}, false, false};
  try {
    std::vector<std::filesystem::path> missing;
    for (auto folder = dir; !folder.empty() && !std::filesystem::exists(folder); folder = folder.parent_path())
      missing.push_back(folder);
    for (auto folder = missing.rbegin(); folder != missing.rend(); ++folder)
      if (std::filesystem::create_directory(*folder)) made.folders.push_back(*folder);
    if (!std::filesystem::exists(dir / database_name)) check_is_empty(dir);
    made.log_is_new = !std::filesystem::exists(dir / log_folder);
    if (!made.log_is_new && !std::filesystem::is_directory(dir / log_folder))
      throw InputError(
          "'{}' is a file, but must be a folder: logs go there; move it away, or use another folder for --out",
          (dir / log_folder).string());
  } catch (const std::filesystem::filesystem_error& error) {
    take_back(made);
    throw InputError("cannot use the folder '{}': {}; use another one for --out", dir.string(), error.code().message());
  }
  return made;
}

void take_back(const MadeResults& made) {
  std::error_code ignored;
  {
    Descriptor lock;
    try {
      lock = lock_for_writing(made.dir);
      if (made.database && count_flights(made.dir / database_name) > 0) return;
    } catch (const std::exception&) {
      return;
    }
    if (made.database)
      for (const char* name : {database_name, "results.sqlite-wal", "results.sqlite-shm", "experiment.json"})
        std::filesystem::remove(made.dir / name, ignored);
    if (made.log_is_new) std::filesystem::remove_all(made.dir / log_folder, ignored);
  }
  // remove() deletes only empty folders: another process may have put something there.
  for (auto folder = made.folders.rbegin(); folder != made.folders.rend(); ++folder)
    std::filesystem::remove(*folder, ignored);
}

}  // namespace aloft::store
