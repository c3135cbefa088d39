#include "services/coordinator/folder_lock.hpp"

#include <fcntl.h>
#include <spdlog/spdlog.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <system_error>
#include <thread>
#include <utility>

#include "common/base/error.hpp"
#include "common/base/plain_text.hpp"
#include "common/base/read_file.hpp"
#include "common/store/result_store.hpp"

namespace aloft::coordinator {
namespace {

constexpr std::uint64_t longest_holder_bytes = 4096;

}  // namespace

FolderLock::FolderLock(std::filesystem::path folder, const ProcessName& self, const LockPatience& patience,
                       const std::function<bool()>& stopped)
    : folder_(std::move(folder)), file_(folder_ / store::coordinator_lock_name) {
  const auto start = std::chrono::steady_clock::now();
  for (bool told = false; !take();) {
    const std::string other = holder();
    const bool is_here = other.find(" on host " + self.host + " (") != std::string::npos;
    const auto limit = is_here ? patience.here : patience.elsewhere;
    if (std::chrono::steady_clock::now() - start >= limit || stopped())
      throw InputError("the folder '{}' has a coordinator already: {}; stop that one, or use another folder",
                       folder_.string(), other);
    if (!is_here && !std::exchange(told, true))
      spdlog::warn("waits for the folder '{}', at most {} s: it has a coordinator, {}", folder_.string(),
                   std::chrono::ceil<std::chrono::seconds>(limit).count(), other);
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  }
  write(self);
}

FolderLock::~FolderLock() {
  std::error_code ignored;
  // While it is locked: no other process can have taken it.
  if (fd_.is_open()) std::filesystem::remove(file_, ignored);
  fd_ = Descriptor();
  if (made_folder_) ::rmdir(folder_.c_str());  // if there is nothing in it
}

/// False if another process has it. Its last holder can remove the file (and the folder, if that is empty) just before
/// we lock it; what we locked is then not what others find, and we try again.
bool FolderLock::take() {
  for (;;) {
    std::error_code failed;
    made_folder_ = std::filesystem::create_directories(folder_, failed) || made_folder_;
    fd_ = Descriptor(::open(file_.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0644));
    if (!fd_.is_open() && errno == ENOENT && !failed) continue;
    if (!fd_.is_open()) return true;
    if (::flock(fd_.get(), LOCK_EX | LOCK_NB) != 0) {
      const bool taken = errno == EWOULDBLOCK;
      fd_ = Descriptor();
      return !taken;
    }
    struct stat ours {};
    struct stat theirs {};
    if (::fstat(fd_.get(), &ours) == 0 && ::stat(file_.c_str(), &theirs) == 0 && ours.st_ino == theirs.st_ino &&
        ours.st_dev == theirs.st_dev)
      return true;
    fd_ = Descriptor();
  }
}

void FolderLock::write(const ProcessName& self) const {
  const std::string text = to_text(self, "aloft-coordinator") + "\n";
  if (fd_.is_open() && ::ftruncate(fd_.get(), 0) == 0) (void)!::write(fd_.get(), text.data(), text.size());
}

std::string FolderLock::holder() const {
  std::string text;
  try {
    text = read_file(file_, longest_holder_bytes);
  } catch (const InputError&) {  // it is gone by now, or its holder wrote no name
  }
  const std::string line = text.substr(0, text.find('\n'));
  return line.empty() ? "another process" : plain_text(line);
}

}  // namespace aloft::coordinator
