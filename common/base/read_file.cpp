#include "common/base/read_file.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <system_error>

#include "common/base/descriptor.hpp"
#include "common/base/error.hpp"
#include "common/base/plain_text.hpp"

namespace aloft {
namespace {

/// A file open for reading.
class Source {
 public:
  /// O_NONBLOCK: opening a pipe without a writer would never return.
  explicit Source(const std::filesystem::path& file)
      : file_(file), fd_(::open(file.c_str(), O_RDONLY | O_NONBLOCK | O_NOCTTY | O_CLOEXEC)) {
    if (!fd_.is_open()) refuse_for(errno);
  }

  [[noreturn]] void refuse(const std::string& why) const {
    throw InputError("cannot read '{}': {}", excerpt(file_.string()), why);
  }
  [[noreturn]] void refuse_for(int error) const { refuse(std::generic_category().message(error)); }

  /// Reads at most the size of the buffer; returns 0 at the end.
  template <std::size_t size>
  [[nodiscard]] std::size_t read(std::array<char, size>& buffer) const {
    while (true) {
      const ssize_t count = ::read(fd_.get(), buffer.data(), size);
      if (count >= 0) return static_cast<std::size_t>(count);
      if (errno != EINTR) refuse_for(errno);
    }
  }

  void check_kind() const {
    struct stat facts {};
    if (::fstat(fd_.get(), &facts) != 0) refuse_for(errno);
    if (S_ISDIR(facts.st_mode)) refuse("it is a folder, not a file");
    if (!S_ISREG(facts.st_mode))
      refuse(fmt::format("it is a {}, not a file; save what comes out of it to a file, and name that",
                         S_ISFIFO(facts.st_mode) ? "pipe" : "device"));
  }

 private:
  const std::filesystem::path& file_;
  Descriptor fd_;
};

}  // namespace

std::string read_file(const std::filesystem::path& file, std::uint64_t largest_bytes) {
  const Source source(file);
  source.check_kind();
  std::string content;
  std::array<char, 65536> buffer;
  while (const std::size_t count = source.read(buffer)) {
    content.append(buffer.data(), count);
    if (content.size() > largest_bytes)
      source.refuse(fmt::format("it has more than {} bytes, the most that such a file may have", largest_bytes));
  }
  return content;
}

}  // namespace aloft
