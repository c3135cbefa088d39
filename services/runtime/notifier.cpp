#include "services/runtime/notifier.hpp"

#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <algorithm>
#include <cstddef>
#include <cstdlib>
#include <cstring>
#include <string_view>

namespace aloft::runtime {
namespace {

constexpr int pings_per_period = 4;

std::string take_variable(const char* name) {
  const char* value = std::getenv(name);
  std::string copy = value != nullptr ? value : "";
  unsetenv(name);
  return copy;
}

/// Connected to the manager's socket; -1 if that cannot be.
int connect_to(const std::string& path) {
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  if (path.empty() || path.size() >= sizeof address.sun_path) return -1;
  std::copy(path.begin(), path.end(), address.sun_path);
  if (path.front() == '@') address.sun_path[0] = '\0';  // the abstract namespace
  const int descriptor = socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  const auto length = static_cast<socklen_t>(offsetof(sockaddr_un, sun_path) + path.size());
  // The socket API's own way to pass an address of any family.
  if (connect(descriptor, reinterpret_cast<const sockaddr*>(&address), length) == 0) return descriptor;  // NOLINT
  close(descriptor);
  return -1;
}

}  // namespace

Notifier::Notifier() : socket_(connect_to(take_variable("NOTIFY_SOCKET"))) {
  const std::string pid = take_variable("WATCHDOG_PID");
  const std::string period_us = take_variable("WATCHDOG_USEC");
  if (pid.empty() || pid == std::to_string(getpid()))
    watchdog_period_ = std::chrono::microseconds(std::strtoll(period_us.c_str(), nullptr, 10));
}

Notifier::~Notifier() {
  send("STOPPING=1");
  if (socket_ >= 0) close(socket_);
}

void Notifier::ready(const std::string& status) {
  send("READY=1\nSTATUS=" + status);
  alive();
}

void Notifier::alive() {
  const auto now = Clock::now();
  if (watchdog_period_ == Clock::duration::zero() || now - told_ < watchdog_period_ / pings_per_period) return;
  told_ = now;
  send("WATCHDOG=1");
}

void Notifier::send(const std::string& message) const {
  // A manager that does not listen must not hold us up.
  if (socket_ >= 0) static_cast<void>(::send(socket_, message.data(), message.size(), MSG_NOSIGNAL | MSG_DONTWAIT));
}

}  // namespace aloft::runtime
