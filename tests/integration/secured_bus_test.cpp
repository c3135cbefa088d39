// What the middleware must do for a secured run: let everybody meet who starts at the same time, and remember who stood
// still for a while.
#include <signal.h>
#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <catch2/catch.hpp>
#include <chrono>
#include <deque>
#include <thread>

#include "common/bus/endpoint.hpp"
#include "common/bus/keys.hpp"
#include "tests/integration/command.hpp"

using namespace aloft;
using namespace aloft::test;
using namespace std::chrono_literals;
using bus::Role;
namespace fs = std::filesystem;

namespace {

constexpr std::size_t pairs = 8;
constexpr auto limit = 60s;

/// What the processes of a test tell it: whom they have met, and the last sample.
struct Shared {
  std::array<std::atomic<std::size_t>, pairs> readers_met;  // by channel
  std::array<std::atomic<std::size_t>, pairs> writers_met;  // by environment
  std::atomic<std::uint64_t> heard;
};

/// Channels, which write WorkerStatus, and environments, which read it: each a process of its own with keys.
class Crowd {
 public:
  Crowd() : shared_(map()) {
    bus::init_keys(keys_.path() / "keys", 10);
    for (const Role role : {Role::channel, Role::environment})
      bus::issue_keys(keys_.path() / "keys", {.role = role, .name = std::string(bus::to_text(role))},
                      keys_.path() / "keys");
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
      for (;; std::this_thread::sleep_for(50ms)) {
        statuses.drain([this](const wire::WorkerStatus& status) { shared_.heard = status.steps_done(); });
        shared_.writers_met[index] = statuses.matched();
      }
    });
  }
  [[nodiscard]] const Shared& shared() const { return shared_; }

 private:
  static Shared& map() {
    void* memory = mmap(nullptr, sizeof(Shared), PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
    REQUIRE(memory != MAP_FAILED);
    return *new (memory) Shared();
  }
  [[nodiscard]] bus::BusOptions place(Role role) const {
    bus::BusOptions options;
    options.run = "secured-bus-" + std::to_string(getpgrp());
    options.process = bus::to_text(role);
    options.domain = domain_;
    options.secure = keys_.path() / "keys";
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

}  // namespace

TEST_CASE("all processes of a secured run that start together meet") {
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

TEST_CASE("processes of a secured run that stood still for seconds go on") {
  Crowd crowd;
  const pid_t writer = crowd.start_channel(0);
  const pid_t reader = crowd.start_environment(0);
  const auto goes_on = [&] {
    const std::uint64_t before = crowd.shared().heard;
    return within(limit, [&] { return crowd.shared().heard > before; });
  };
  REQUIRE(goes_on());
  for (const pid_t sleeper : {writer, reader}) {
    INFO("stands still: who " << (sleeper == writer ? "writes" : "reads"));
    kill(sleeper, SIGSTOP);
    std::this_thread::sleep_for(3s);
    kill(sleeper, SIGCONT);
    CHECK(goes_on());
  }
}
