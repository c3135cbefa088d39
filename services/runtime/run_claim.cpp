#include "services/runtime/run_claim.hpp"

#include <fmt/format.h>
#include <sys/socket.h>
#include <sys/un.h>

#include <algorithm>
#include <cerrno>
#include <cstddef>

namespace aloft::runtime {

RunClaim::RunClaim(std::string_view run, int domain, std::string_view what)
    : name_(fmt::format("aloft/{}/{}/{}", domain, what, run)) {}

bool RunClaim::take() {
  if (socket_.is_open()) return true;
  sockaddr_un address{};
  address.sun_family = AF_UNIX;  // the name begins with a zero byte: it is no file
  const std::size_t length = std::min(name_.size(), sizeof address.sun_path - 1);
  std::copy_n(name_.begin(), length, address.sun_path + 1);
  const auto size = static_cast<socklen_t>(offsetof(sockaddr_un, sun_path) + 1 + length);
  Descriptor socket(::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0));
  if (socket.is_open() && ::bind(socket.get(), reinterpret_cast<const sockaddr*>(&address), size) == 0) {
    socket_ = std::move(socket);
    return true;
  }
  return !socket.is_open() || errno != EADDRINUSE;  // without abstract sockets, no process is refused
}

}  // namespace aloft::runtime
