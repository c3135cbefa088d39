#include "common/bus/test_faults.hpp"

#include <arpa/inet.h>
#include <fastdds/rtps/network/SenderResource.h>
#include <fastdds/rtps/transport/ChainingTransport.h>
#include <fastdds/rtps/transport/ChainingTransportDescriptor.h>
#include <fastrtps/utils/IPLocator.h>
#include <fmt/format.h>
#include <netinet/in.h>
#include <spdlog/spdlog.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <charconv>
#include <condition_variable>
#include <cstdlib>
#include <map>
#include <mutex>
#include <set>
#include <thread>
#include <vector>

#include "common/base/error.hpp"
#include "common/base/random.hpp"
#include "common/bus/rtps_message.hpp"

namespace aloft::bus {
namespace {

namespace transport = eprosima::fastdds::rtps;
namespace rtps = eprosima::fastrtps::rtps;
using Clock = std::chrono::steady_clock;

constexpr const char* variable = "ALOFT_TEST_FAULTS";
constexpr unsigned max_delay_ms = 60'000;
/// In the variable and in the log, by TestFault.
constexpr std::array<std::string_view, test_fault_count> names{"data", "data_frag", "heartbeat", "acknack",
                                                               "gap",  "any",       "duplicate", "delay"};

unsigned number(std::string_view name, std::string_view text, unsigned limit) {
  unsigned value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error == std::errc() && end == text.data() + text.size() && value <= limit) return value;
  throw InputError(fmt::format("{}: {}={} is out of range; allowed: 0 to {}", variable, name, text, limit));
}

/// The kinds of submessages in a message, each once.
std::set<unsigned> kinds_in(const rtps::octet* bytes, std::size_t size) {
  std::set<unsigned> kinds;
  rtps_message::all_submessages(bytes, size, [&](unsigned kind, const rtps::octet* /*content*/, std::size_t /*size*/) {
    kinds.insert(kind);
    return true;
  });
  return kinds;
}

/// Sends datagrams later than they were meant to be, from a socket of its own: the middleware's may be closed by then.
class LateSender {
 public:
  explicit LateSender(const std::vector<std::string>& interfaces) : socket_(::socket(AF_INET, SOCK_DGRAM, 0)) {
    in_addr address{};
    if (!interfaces.empty() && inet_pton(AF_INET, interfaces.front().c_str(), &address) == 1)
      setsockopt(socket_, IPPROTO_IP, IP_MULTICAST_IF, &address, sizeof address);
    thread_ = std::thread([this] { work(); });
  }
  ~LateSender() {
    {
      const std::lock_guard lock(mutex_);
      ending_ = true;
    }
    changed_.notify_all();
    thread_.join();
    close(socket_);
  }
  LateSender(const LateSender&) = delete;
  LateSender& operator=(const LateSender&) = delete;

  void send(Clock::time_point when, const rtps::Locator_t& to, std::vector<rtps::octet> bytes) {
    {
      const std::lock_guard lock(mutex_);
      waiting_.emplace(when, Datagram{to, std::move(bytes)});
    }
    changed_.notify_all();
  }

 private:
  struct Datagram {
    rtps::Locator_t to;
    std::vector<rtps::octet> bytes;
  };

  void work() {
    std::unique_lock lock(mutex_);
    while (!ending_) {
      if (waiting_.empty()) {
        changed_.wait(lock);
      } else if (const auto due = waiting_.begin()->first; due > Clock::now()) {
        changed_.wait_until(lock, due);
      } else {
        const Datagram datagram = std::move(waiting_.begin()->second);
        waiting_.erase(waiting_.begin());
        lock.unlock();
        deliver(datagram);
        lock.lock();
      }
    }
  }

  void deliver(const Datagram& datagram) const {
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_port = htons(rtps::IPLocator::getPhysicalPort(datagram.to));
    std::copy_n(rtps::IPLocator::getIPv4(datagram.to), 4, reinterpret_cast<unsigned char*>(&address.sin_addr));
    // Lost if the receiver's buffer is full, as any datagram.
    (void)sendto(socket_, datagram.bytes.data(), datagram.bytes.size(), MSG_DONTWAIT,
                 reinterpret_cast<const sockaddr*>(&address), sizeof address);
  }

  int socket_;
  std::mutex mutex_;
  std::condition_variable changed_;
  std::multimap<Clock::time_point, Datagram> waiting_;
  bool ending_ = false;
  std::thread thread_;
};

struct FaultyDescriptor : transport::ChainingTransportDescriptor {
  FaultyDescriptor(std::shared_ptr<TransportDescriptorInterface> below, const TestFaults& wanted,
                   std::vector<std::string> addresses)
      : ChainingTransportDescriptor(std::move(below)), faults(wanted), interfaces(std::move(addresses)) {}
  [[nodiscard]] transport::TransportInterface* create_transport() const override;

  TestFaults faults;
  std::vector<std::string> interfaces;
};

/// Loses, duplicates and holds back what is sent; copies come late, too. (The middleware's own test transport loses
/// messages by counting submessages: an answer that carries many samples would be lost every time.)
class FaultyTransport : public transport::ChainingTransport {
 public:
  explicit FaultyTransport(const FaultyDescriptor& descriptor)
      : ChainingTransport(descriptor), descriptor_(descriptor), late_(descriptor.interfaces) {}
  ~FaultyTransport() override {
    std::string text;
    for (std::size_t i = 0; i < test_fault_count; ++i) text += fmt::format(" {}={}", names.at(i), counts_.at(i).load());
    spdlog::info("{}: messages that were damaged:{}", variable, text);
  }
  FaultyTransport(const FaultyTransport&) = delete;
  FaultyTransport& operator=(const FaultyTransport&) = delete;

  transport::TransportDescriptorInterface* get_configuration() override { return &descriptor_; }

  bool send(rtps::SenderResource* below, const rtps::octet* bytes, std::uint32_t size,
            transport::LocatorsIterator* begin, transport::LocatorsIterator* end,
            const Clock::time_point& timeout) override {
    if (lost(bytes, size)) return true;
    transport::LocatorList destinations;  // the middleware's iterators can be walked only once
    for (; *begin != *end; ++*begin) destinations.push_back(**begin);
    if (happens(TestFault::duplicate)) send_late(destinations, {bytes, bytes + size});
    if (happens(TestFault::delay)) {
      send_late(destinations, {bytes, bytes + size});
      return true;
    }
    transport::Locators first(destinations.begin());
    transport::Locators last(destinations.end());
    return below->send(bytes, size, &first, &last, timeout);
  }

  void receive(transport::TransportReceiverInterface* next, const rtps::octet* bytes, std::uint32_t size,
               const rtps::Locator_t& local, const rtps::Locator_t& remote) override {
    next->OnDataReceived(bytes, size, local, remote);
  }

 private:
  bool lost(const rtps::octet* bytes, std::size_t size) {
    if (happens(TestFault::any)) return true;
    using namespace rtps_message;
    const std::set<unsigned> kinds = kinds_in(bytes, size);
    return (kinds.contains(data) && happens(TestFault::data)) ||
           (kinds.contains(data_frag) && happens(TestFault::data_frag)) ||
           (kinds.contains(heartbeat) && happens(TestFault::heartbeat)) ||
           (kinds.contains(acknack) && happens(TestFault::acknack)) || (kinds.contains(gap) && happens(TestFault::gap));
  }

  /// Draws whether this fault happens now, and counts it.
  bool happens(TestFault fault) {
    const auto index = static_cast<std::size_t>(fault);
    const unsigned percent = descriptor_.faults.percent.at(index);
    if (percent == 0) return false;
    const std::lock_guard lock(mutex_);
    const bool hit = random_.uniform_index(100) < percent;
    if (hit) ++counts_.at(index);
    return hit;
  }
  void send_late(const transport::LocatorList& destinations, const std::vector<rtps::octet>& bytes) {
    const std::lock_guard lock(mutex_);
    const auto limit_us = static_cast<std::uint32_t>(descriptor_.faults.delay_limit.count() * 1000);
    const auto when = Clock::now() + std::chrono::microseconds(random_.uniform_index(limit_us));
    for (const rtps::Locator_t& to : destinations) late_.send(when, to, bytes);
  }

  FaultyDescriptor descriptor_;
  std::mutex mutex_;
  std::array<std::atomic<std::uint64_t>, test_fault_count> counts_{};
  RandomStream random_{static_cast<std::uint64_t>(getpid()), 0, variable};
  LateSender late_;
};

transport::TransportInterface* FaultyDescriptor::create_transport() const {
  return new FaultyTransport(*this);
}

}  // namespace

TestFaults parse_test_faults(std::string_view text) {
  TestFaults faults;
  unsigned delay_ms = static_cast<unsigned>(faults.delay_limit.count());
  while (!text.empty()) {
    const std::string_view part = text.substr(0, text.find(','));
    const std::string_view name = part.substr(0, part.find('='));
    const auto at = std::find(names.begin(), names.end(), name);
    const bool is_limit = name == "delay_ms";
    if ((at == names.end() && !is_limit) || name.size() == part.size())
      throw InputError(fmt::format(
          "{}: '{}' is unknown; use data=, data_frag=, heartbeat=, acknack=, gap=, any=, duplicate=, delay= (percent) "
          "and delay_ms=, separated by commas",
          variable, part));
    const unsigned value = number(name, part.substr(name.size() + 1), is_limit ? max_delay_ms : 100);
    if (is_limit)
      delay_ms = value;
    else
      faults.percent.at(static_cast<std::size_t>(at - names.begin())) = value;
    text.remove_prefix(std::min(text.size(), part.size() + 1));
  }
  faults.delay_limit = std::chrono::milliseconds(std::max(1U, delay_ms));
  return faults;
}

std::shared_ptr<transport::TransportDescriptorInterface> with_test_faults(
    std::shared_ptr<transport::UDPv4TransportDescriptor> udp) {
  const char* wanted = std::getenv(variable);
  if (wanted == nullptr || *wanted == '\0') return udp;
  const TestFaults faults = parse_test_faults(wanted);
  spdlog::warn("{}={}: this process damages its own messages", variable, wanted);
  return std::make_shared<FaultyDescriptor>(udp, faults, udp->interfaceWhiteList);
}

}  // namespace aloft::bus
