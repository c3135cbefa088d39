// What a secured run needs from the middleware: processes that start together find each other, peers that were stopped
// for a while are remembered, and clear text is dropped.
#include <arpa/inet.h>
#include <netinet/in.h>
#include <signal.h>
#include <sys/mman.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <catch2/catch.hpp>
#include <chrono>
#include <deque>
#include <idl/type_supports.hpp>
#include <thread>
#include <vector>

#include "common/bus/endpoint.hpp"
#include "common/security/keys.hpp"
#include "tests/faults/rogue.hpp"
#include "tests/integration/command.hpp"

using namespace aloft;
using namespace aloft::test;
using namespace std::chrono_literals;
using security::Role;

namespace {

constexpr std::size_t pairs = 8;
constexpr auto limit = 60s;
constexpr std::uint64_t lie = 4'711'000;  // steps_done of forged samples

/// Memory in which a test's processes report the peers that they have found, and the last sample.
struct Shared {
  std::array<std::atomic<std::size_t>, pairs> readers_met;  // by channel
  std::array<std::atomic<std::size_t>, pairs> writers_met;  // by environment
  std::atomic<std::uint64_t> heard;
  std::atomic<bool> believed;            // a forged sample was accepted
  std::array<unsigned char, 12> writer;  // the address of channel 0 on the wire
  std::atomic<bool> writer_known;
};

/// Channels, which write WorkerStatus, and environments, which read it: each a process of its own with keys.
class Crowd {
 public:
  explicit Crowd(bool secured = true) : secured_(secured), shared_(map()) {
    security::init_keys(keys_.path() / "keys", 10);
    for (const Role role : {Role::channel, Role::environment})
      security::issue_keys(keys_.path() / "keys", {.role = role, .name = std::string(security::to_text(role))},
                           bus::topic_rights(role), keys_.path() / "keys");
  }
  ~Crowd() {
    for (const pid_t child : children_) {
      kill(child, SIGKILL);
      waitpid(child, nullptr, 0);
    }
    munmap(&shared_, sizeof shared_);
  }
  Crowd(const Crowd&) = delete;
  Crowd& operator=(const Crowd&) = delete;

  pid_t start_channel(std::size_t index) {
    return start([this, index] {
      const bus::Participant participant(place(Role::channel));
      bus::Writer<wire::WorkerStatus> statuses(participant);
      if (index == 0) {
        const auto& address = participant.state()->participant->guid().guidPrefix.value;
        std::copy(std::begin(address), std::end(address), shared_.writer.begin());
        shared_.writer_known = true;
      }
      wire::WorkerStatus status;
      status.worker("w0");
      for (std::uint64_t steps = 1;; ++steps, std::this_thread::sleep_for(50ms)) {
        status.steps_done(steps);
        statuses.write(status);
        shared_.readers_met[index] = statuses.matched();
      }
    });
  }
  pid_t start_environment(std::size_t index) {
    return start([this, index] {
      const bus::Participant participant(place(Role::environment));
      bus::Reader<wire::WorkerStatus> statuses(participant);
      for (;; std::this_thread::sleep_for(5ms)) {
        statuses.drain([this](const wire::WorkerStatus& status) {
          if (status.steps_done() == lie)
            shared_.believed = true;
          else
            shared_.heard = status.steps_done();
        });
        shared_.writers_met[index] = statuses.matched();
      }
    });
  }
  [[nodiscard]] const Shared& shared() const { return shared_; }
  [[nodiscard]] int domain() const { return domain_; }

 private:
  static Shared& map() {
    void* memory = mmap(nullptr, sizeof(Shared), PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
    REQUIRE(memory != MAP_FAILED);
    return *new (memory) Shared();
  }
  [[nodiscard]] bus::BusOptions place(Role role) const {
    bus::BusOptions options;
    options.run = "secured-bus-" + std::to_string(getpgrp());
    options.process = security::to_text(role);
    options.domain = domain_;
    if (secured_) options.secure = keys_.path() / "keys";
    options.role = role;
    return options;
  }
  template <class Work>
  pid_t start(Work work) {
    const pid_t test = getpid();
    const pid_t child = fork();
    if (child == 0) {
      die_with(test);
      work();
    }
    children_.push_back(child);
    return child;
  }

  ScratchDir keys_;
  const int domain_ = std::stoi(test_domain());  // of this process, not of its children
  bool secured_;
  Shared& shared_;
  std::deque<pid_t> children_;
};

template <class Done>
bool within(std::chrono::milliseconds time, Done done) {
  const auto end = std::chrono::steady_clock::now() + time * slowdown;
  while (!done()) {
    if (std::chrono::steady_clock::now() > end) return false;
    std::this_thread::sleep_for(20ms);
  }
  return true;
}

using Bytes = std::vector<unsigned char>;

void append(Bytes& message, const Bytes& more) {
  message.insert(message.end(), more.begin(), more.end());
}

/// An RTPS message in clear text, as if the `entity`-th endpoint of `writer` had written `payload` as its sample
/// `number` (RTPS 2.2, 9.4).
Bytes forged(const std::array<unsigned char, 12>& writer, unsigned char entity, std::uint32_t number,
             const Bytes& payload) {
  constexpr unsigned char writer_with_key = 0x02;
  Bytes message{'R', 'T', 'P', 'S', 2, 2, 1, 15};
  append(message, {writer.begin(), writer.end()});
  const auto length = static_cast<std::uint32_t>(20 + payload.size());
  append(message, {0x15, 0x05, static_cast<unsigned char>(length & 255U), static_cast<unsigned char>(length >> 8U)});
  append(message, {0, 0, 16, 0, 0, 0, 0, 0, 0, 0, entity, writer_with_key, 0, 0, 0, 0});
  for (const unsigned shift : {0U, 8U, 16U, 24U}) message.push_back(static_cast<unsigned char>(number >> shift));
  append(message, payload);
  return message;
}

/// Sends forged samples with the next sequence numbers to the ports of all processes.
void forge(const Crowd& crowd, const Bytes& payload) {
  const int socket_fd = socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  sockaddr_in to{};
  to.sin_family = AF_INET;
  to.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  const auto next = static_cast<std::uint32_t>(crowd.shared().heard) + 1;
  for (std::uint32_t number = next; number < next + 3; ++number)
    for (unsigned char entity = 1; entity < 6; ++entity) {
      const Bytes message = forged(crowd.shared().writer, entity, number, payload);
      for (int offset = 10; offset < 22; ++offset) {
        to.sin_port = htons(static_cast<std::uint16_t>(7400 + 250 * crowd.domain() + offset));
        (void)sendto(socket_fd, message.data(), message.size(), 0, reinterpret_cast<const sockaddr*>(&to), sizeof to);
      }
    }
  close(socket_fd);
}

}  // namespace

TEST_CASE("all processes of a secured run that start together find each other") {
  Crowd crowd;
  for (std::size_t i = 0; i < pairs; ++i) {
    crowd.start_channel(i);
    crowd.start_environment(i);
  }
  const auto met = [&] {
    std::size_t sum = 0;
    for (std::size_t i = 0; i < pairs; ++i) sum += crowd.shared().readers_met[i] + crowd.shared().writers_met[i];
    return sum;
  };
  (void)within(limit, [&] { return met() == 2 * pairs * pairs; });
  CHECK(met() == 2 * pairs * pairs);
}

TEST_CASE("processes of a secured run that were stopped for seconds go on") {
  Crowd crowd;
  const pid_t writer = crowd.start_channel(0);
  const pid_t reader = crowd.start_environment(0);
  const auto goes_on = [&] {
    const std::uint64_t before = crowd.shared().heard;
    return within(limit, [&] { return crowd.shared().heard > before; });
  };
  REQUIRE(goes_on());
  for (const pid_t sleeper : {writer, reader}) {
    INFO("stopped: the " << (sleeper == writer ? "writer" : "reader"));
    kill(sleeper, SIGSTOP);
    std::this_thread::sleep_for(3s);
    kill(sleeper, SIGCONT);
    CHECK(goes_on());
  }
}

TEST_CASE("a forged sample in clear text is accepted only in an unsecured run") {
  wire::WorkerStatus sample;
  sample.worker("w0");
  sample.steps_done(lie);
  sample.protocol_version(wire::PROTOCOL_VERSION);
  const Bytes payload = test::Rogue<wire::WorkerStatus, wire::WorkerStatusPubSubType>::bytes_of(sample);
  for (const bool secured : {false, true}) {
    INFO((secured ? "secured" : "not secured"));
    Crowd crowd(secured);
    crowd.start_channel(0);
    crowd.start_environment(0);
    REQUIRE(within(limit, [&] { return crowd.shared().writer_known && crowd.shared().heard > 0; }));
    for (int round = 0; round < 30 && !crowd.shared().believed; ++round) {
      const std::uint64_t before = crowd.shared().heard;
      forge(crowd, payload);
      CHECK(within(limit, [&] { return crowd.shared().heard > before; }));  // true samples still arrive
    }
    CHECK(crowd.shared().believed == !secured);
  }
}
