#include "services/runtime/notifier.hpp"

#include <fcntl.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <array>
#include <catch2/catch.hpp>
#include <cstddef>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <thread>

using aloft::runtime::Notifier;

namespace {

/// A service manager: a datagram socket in the file system (or, from '@', the abstract namespace).
class Manager {
 public:
  explicit Manager(std::string path) : path_(std::move(path)), socket_(socket(AF_UNIX, SOCK_DGRAM | SOCK_NONBLOCK, 0)) {
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    path_.copy(address.sun_path, sizeof address.sun_path - 1);
    if (path_.front() == '@') address.sun_path[0] = '\0';
    const auto length = static_cast<socklen_t>(offsetof(sockaddr_un, sun_path) + path_.size());
    REQUIRE(bind(socket_, reinterpret_cast<const sockaddr*>(&address), length) == 0);  // NOLINT
    setenv("NOTIFY_SOCKET", path_.c_str(), 1);
  }
  ~Manager() {
    close(socket_);
    std::filesystem::remove(path_);
  }
  Manager(const Manager&) = delete;
  Manager& operator=(const Manager&) = delete;

  /// The next message; empty if there is none.
  [[nodiscard]] std::string take() const {
    std::array<char, 256> buffer{};
    const ssize_t size = recv(socket_, buffer.data(), buffer.size(), 0);
    return size > 0 ? std::string(buffer.data(), static_cast<std::size_t>(size)) : "";
  }

 private:
  std::string path_;
  int socket_;
};

}  // namespace

TEST_CASE("the service manager is told: ready, alive while the loop runs, stopping") {
  const std::string pid = std::to_string(getpid());
  for (const std::string& path : {"/tmp/aloft-notify-" + pid, "@aloft-notify-" + pid}) {
    const Manager manager(path);
    setenv("WATCHDOG_USEC", "40000", 1);
    setenv("WATCHDOG_PID", pid.c_str(), 1);
    {
      Notifier notifier;
      CHECK(manager.take().empty());
      notifier.ready("flies");
      CHECK(manager.take() == "READY=1\nSTATUS=flies");
      CHECK(manager.take() == "WATCHDOG=1");
      std::this_thread::sleep_for(std::chrono::milliseconds(30));
      CHECK(manager.take().empty());  // the loop has not reported that it runs
      notifier.alive();
      CHECK(manager.take() == "WATCHDOG=1");
    }
    CHECK(manager.take() == "STOPPING=1");
  }
}

TEST_CASE("a child does not report for its parent") {
  const Manager manager("@aloft-notify-child-" + std::to_string(getpid()));
  setenv("WATCHDOG_USEC", "1000", 1);
  unsetenv("WATCHDOG_PID");
  {
    Notifier notifier(true);
    notifier.ready("flies");
    notifier.alive();
  }
  CHECK(manager.take().empty());
}

TEST_CASE("a watchdog for another process is not fed, and a missing service manager does no harm") {
  const Manager manager("@aloft-notify-other-" + std::to_string(getpid()));
  setenv("WATCHDOG_USEC", "1000", 1);
  setenv("WATCHDOG_PID", "1", 1);
  {
    Notifier notifier;
    notifier.alive();
    CHECK(manager.take().empty());
  }
  setenv("NOTIFY_SOCKET", "/nobody/listens/here", 1);
  Notifier deaf;
  deaf.ready("x");
  deaf.alive();
}
