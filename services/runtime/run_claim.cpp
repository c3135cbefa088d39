#include "services/runtime/run_claim.hpp"

#include <fmt/format.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstddef>

namespace aloft::runtime {

RunClaim::RunClaim(std::string_view run, int domain, std::string_view what)
    : name_(fmt::format("aloft/{}/{}/{}", domain, what, run)) {}

RunClaim::~RunClaim() {
  if (socket_ >= 0) ::close(socket_);
}

bool RunClaim::take() {
  if (socket_ >= 0) return true;
  sockaddr_un address{};
  address.sun_family = AF_UNIX;  // the name begins with a zero byte: it is no file
  const std::size_t length = std::min(name_.size(), sizeof address.sun_path - 1);
  std::copy_n(name_.begin(), length, address.sun_path + 1);
  const auto size = static_cast<socklen_t>(offsetof(sockaddr_un, sun_path) + 1 + length);
  const int socket = ::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0);
  if (socket >= 0 && ::bind(socket, reinterpret_cast<const sockaddr*>(&address), size) == 0) {
    socket_ = socket;
    return true;
  }
  const bool taken = socket >= 0 && errno == EADDRINUSE;
  if (socket >= 0) ::close(socket);
  return !taken;  // without abstract sockets, no process is refused
}

}  // namespace aloft::runtime
