// A network that loses, duplicates, reorders and delays messages of any program: preload this library, and set
// ALOFT_TEST_FAULTS to the percentage of RTPS messages for each fault (docs/faults.md). The programs are not changed.
// With ALOFT_TEST_RECORD=FILE it notes messages instead, each after its size in two bytes, low byte first.
#include <arpa/inet.h>
#include <dlfcn.h>
#include <fcntl.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <charconv>
#include <chrono>
#include <condition_variable>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <map>
#include <mutex>
#include <random>
#include <set>
#include <string_view>
#include <thread>
#include <vector>

#include "common/bus/middleware/rtps_message.hpp"

namespace {

using Clock = std::chrono::steady_clock;
using Bytes = std::vector<unsigned char>;

constexpr const char* variable = "ALOFT_TEST_FAULTS";

/// The faults. The first five lose a message if it has at least one RTPS submessage of this kind, `any` loses it
/// whatever it holds; `delay` holds it back for a random time, so that others overtake it.
enum Fault : std::size_t { data, data_frag, heartbeat, acknack, gap, any, duplicate, delay };
constexpr std::array<std::string_view, 8> names{"data", "data_frag", "heartbeat", "acknack",
                                                "gap",  "any",       "duplicate", "delay"};

struct Faults {
  std::array<unsigned, names.size()> percent{};
  unsigned delay_ms = 20;
};

[[noreturn]] void refuse(std::string_view part) {
  std::fprintf(stderr,
               "%s: '%.*s' makes no sense; use data=, data_frag=, heartbeat=, acknack=, gap=, any=, duplicate=, delay= "
               "(0 to 100 percent) and delay_ms= (1 to 60000), separated by commas\n",
               variable, static_cast<int>(part.size()), part.data());
  _exit(2);
}

Faults parse(std::string_view text) {
  Faults faults;
  while (!text.empty()) {
    const std::string_view part = text.substr(0, text.find(','));
    const std::string_view name = part.substr(0, part.find('='));
    const auto at = std::find(names.begin(), names.end(), name);
    const bool is_delay_ms = name == "delay_ms";
    if ((at == names.end() && !is_delay_ms) || name.size() == part.size()) refuse(part);
    unsigned value = 0;
    const char* const end = part.data() + part.size();
    const auto [stop, error] = std::from_chars(name.data() + name.size() + 1, end, value);
    if (error != std::errc() || stop != end || value > (is_delay_ms ? 60'000U : 100U)) refuse(part);
    (is_delay_ms ? faults.delay_ms : faults.percent.at(static_cast<std::size_t>(at - names.begin()))) = value;
    text.remove_prefix(std::min(text.size(), part.size() + 1));
  }
  faults.delay_ms = std::max(1U, faults.delay_ms);
  return faults;
}

template <class Function>
Function* next(const char* name) {
  return reinterpret_cast<Function*>(dlsym(RTLD_NEXT, name));
}

/// Draws the faults of each message, and sends delayed ones from a socket of its own, because the program can close its
/// own meanwhile. Never destroyed, because other threads can send until the process ends.
class BadNetwork {
 public:
  explicit BadNetwork(const Faults& faults) : faults_(faults) {}

  /// True if the message must not be sent now.
  bool takes(int socket_fd, const Bytes& bytes, const sockaddr_in& to) {
    const std::lock_guard lock(mutex_);
    if (lost(bytes)) return true;
    if (happens(duplicate)) send_late(socket_fd, bytes, to);
    if (!happens(delay)) return false;
    send_late(socket_fd, bytes, to);
    return true;
  }

  void tell() {
    const std::lock_guard lock(mutex_);
    std::fprintf(stderr, "%s: messages that were damaged:", variable);
    for (std::size_t i = 0; i < names.size(); ++i) std::fprintf(stderr, " %s=%u", names.at(i).data(), counts_.at(i));
    std::fputc('\n', stderr);
  }

 private:
  struct Late {
    sockaddr_in to;
    in_addr multicast_interface;
    Bytes bytes;
  };

  bool happens(Fault fault) {
    const bool hit = random_() % 100 < faults_.percent.at(fault);
    if (hit) ++counts_.at(fault);
    return hit;
  }

  bool lost(const Bytes& bytes) {
    if (happens(any)) return true;
    namespace rtps = aloft::bus::rtps_message;
    std::set<unsigned> kinds;
    rtps::all_submessages(bytes.data(), bytes.size(), [&](unsigned kind, const unsigned char*, std::size_t) {
      kinds.insert(kind);
      return true;
    });
    return (kinds.contains(rtps::data) && happens(data)) || (kinds.contains(rtps::data_frag) && happens(data_frag)) ||
           (kinds.contains(rtps::heartbeat) && happens(heartbeat)) ||
           (kinds.contains(rtps::acknack) && happens(acknack)) || (kinds.contains(rtps::gap) && happens(gap));
  }

  void send_late(int socket_fd, const Bytes& bytes, const sockaddr_in& to) {
    in_addr through{};
    socklen_t size = sizeof through;
    getsockopt(socket_fd, IPPROTO_IP, IP_MULTICAST_IF, &through, &size);
    waiting_.emplace(Clock::now() + std::chrono::microseconds(random_() % (1000 * faults_.delay_ms)),
                     Late{to, through, bytes});
    if (own_socket_ < 0) {
      own_socket_ = socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
      std::thread([this] { work(); }).detach();
    }
    changed_.notify_one();
  }

  [[noreturn]] void work() {
    auto* const send = next<decltype(sendto)>("sendto");
    std::unique_lock lock(mutex_);
    for (;;) {
      if (waiting_.empty()) {
        changed_.wait(lock);
      } else if (const auto due = waiting_.begin()->first; due > Clock::now()) {
        changed_.wait_until(lock, due);
      } else {
        const Late late = std::move(waiting_.extract(waiting_.begin()).mapped());
        // Like any datagram, it is lost if the receiver's buffer is full.
        setsockopt(own_socket_, IPPROTO_IP, IP_MULTICAST_IF, &late.multicast_interface, sizeof(in_addr));
        send(own_socket_, late.bytes.data(), late.bytes.size(), MSG_DONTWAIT,
             reinterpret_cast<const sockaddr*>(&late.to), sizeof late.to);
      }
    }
  }

  const Faults faults_;
  std::mutex mutex_;
  std::condition_variable changed_;
  std::mt19937 random_{static_cast<unsigned>(getpid())};
  std::array<unsigned, names.size()> counts_{};
  std::multimap<Clock::time_point, Late> waiting_;
  int own_socket_ = -1;
};

BadNetwork* from_environment() {
  const char* wanted = std::getenv(variable);
  return wanted == nullptr || *wanted == '\0' ? nullptr : new BadNetwork(parse(wanted));
}

BadNetwork* const network = from_environment();

/// Notes the first messages of a process, among which are those of discovery, and later a sample of them. All processes
/// append to the same file, each message in one call.
class Recorder {
 public:
  explicit Recorder(const char* file) : fd_(open(file, O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC, 0666)) {}

  void note(const Bytes& bytes) {
    constexpr unsigned first = 1000;
    constexpr unsigned sampling = 16;
    const unsigned number = ++seen_;
    if (number > first && number % sampling != 0) return;
    Bytes sized{static_cast<unsigned char>(bytes.size()), static_cast<unsigned char>(bytes.size() >> 8U)};
    sized.insert(sized.end(), bytes.begin(), bytes.end());
    [[maybe_unused]] const ssize_t written = write(fd_, sized.data(), sized.size());
  }

 private:
  int fd_;
  std::atomic<unsigned> seen_{0};
};

Recorder* recorder_from_environment() {
  const char* file = std::getenv("ALOFT_TEST_RECORD");
  return file == nullptr || *file == '\0' ? nullptr : new Recorder(file);
}

Recorder* const recorder = recorder_from_environment();

[[gnu::destructor]] void tell() {
  if (network != nullptr) network->tell();
}

bool taken(int socket_fd, const sockaddr* to, const Bytes& bytes) {
  constexpr std::string_view mark = "RTPS";
  if (to == nullptr || to->sa_family != AF_INET || bytes.size() < mark.size() ||
      !std::equal(mark.begin(), mark.end(), bytes.begin()))
    return false;
  if (recorder != nullptr) recorder->note(bytes);
  if (network == nullptr) return false;
  sockaddr_in address{};
  std::memcpy(&address, to, sizeof address);
  return network->takes(socket_fd, bytes, address);
}

}  // namespace

// The function by which the middleware sends.

extern "C" ssize_t sendto(int fd, const void* buffer, size_t size, int flags, const sockaddr* to, socklen_t to_size) {
  static auto* const real = next<decltype(sendto)>("sendto");
  const auto* const first = static_cast<const unsigned char*>(buffer);
  if (taken(fd, to, {first, first + size})) return static_cast<ssize_t>(size);
  return real(fd, buffer, size, flags, to, to_size);
}

extern "C" ssize_t sendmsg(int fd, const msghdr* message, int flags) {
  static auto* const real = next<decltype(sendmsg)>("sendmsg");
  Bytes bytes;
  for (std::size_t i = 0; i < message->msg_iovlen; ++i) {
    const auto* const first = static_cast<const unsigned char*>(message->msg_iov[i].iov_base);
    bytes.insert(bytes.end(), first, first + message->msg_iov[i].iov_len);
  }
  if (taken(fd, static_cast<const sockaddr*>(message->msg_name), bytes)) return static_cast<ssize_t>(bytes.size());
  return real(fd, message, flags);
}
