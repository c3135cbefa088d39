#include "common/experiment/text_file.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <system_error>

#include "common/base/error.hpp"

namespace aloft::experiment {
namespace {

/// A file descriptor that closes itself.
class Descriptor {
 public:
  Descriptor(const std::filesystem::path& file, int flags) : fd_(::open(file.c_str(), flags | O_CLOEXEC, 0666)) {}
  ~Descriptor() {
    if (fd_ >= 0) ::close(fd_);
  }
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  [[nodiscard]] int get() const noexcept { return fd_; }

 private:
  int fd_;
};

[[noreturn]] void refuse(const std::filesystem::path& file) {
  throw InputError(fmt::format("cannot write '{}': {}", file.string(), std::generic_category().message(errno)));
}

[[noreturn]] void give_up_writing(const std::filesystem::path& temporary, const std::filesystem::path& file) {
  const int reason = errno;
  ::unlink(temporary.c_str());
  errno = reason;
  refuse(file);
}

}  // namespace

void write_text_file(const std::filesystem::path& file, std::string_view text) {
  const std::filesystem::path temporary = file.string() + ".part";
  {
    const Descriptor descriptor(temporary, O_WRONLY | O_CREAT | O_TRUNC);
    if (descriptor.get() < 0) refuse(file);
    while (!text.empty()) {
      const ssize_t count = ::write(descriptor.get(), text.data(), text.size());
      if (count < 0 && errno == EINTR) continue;
      if (count < 0) give_up_writing(temporary, file);
      text.remove_prefix(static_cast<std::size_t>(count));
    }
    if (::fsync(descriptor.get()) != 0) give_up_writing(temporary, file);
  }
  if (::rename(temporary.c_str(), file.c_str()) != 0) give_up_writing(temporary, file);
}

}  // namespace aloft::experiment
