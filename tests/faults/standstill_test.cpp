// Two processes on the bus, of which one or both stand still for a while: they must find each other again.
#include <signal.h>
#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

#include <atomic>
#include <catch2/catch.hpp>
#include <chrono>
#include <thread>

#include "common/base/random.hpp"
#include "common/bus/endpoint.hpp"
#include "common/bus/waiter.hpp"
#include "tests/faults/effort.hpp"
#include "tests/faults/fault_scene.hpp"

namespace aloft {
namespace {

using namespace std::chrono_literals;
using Clock = std::chrono::steady_clock;

bus::BusOptions place(const char* process) {
  bus::BusOptions options;
  options.run = "standstill-" + std::to_string(getpgrp());
  options.worker = "w0";
  options.process = process;
  options.domain = 10 + getpgrp() % 90;
  return options;
}

/// Asks for the next step until it is commanded, again every 100 ms; counts the steps.
[[noreturn]] void ask(std::atomic<std::uint32_t>& steps) {
  const bus::Participant participant(place("asks"));
  bus::Writer<wire::ChannelReport> reports(participant);
  bus::Reader<wire::HeightCommand> commands(participant);
  bus::Waiter waiter;
  waiter.add(commands);
  wire::ChannelReport report;
  report.agent(wire::name("agent"));
  report.height_step_m(10);
  report.steps(1);
  for (std::uint32_t attempt = 1;; ++attempt) {
    report.attempt(attempt);
    for (bool answered = false; !answered;) {
      reports.write(report);
      waiter.wait(100ms);
      commands.drain([&](const wire::HeightCommand& command) { answered = answered || command.attempt() == attempt; });
    }
    ++steps;
  }
}

[[noreturn]] void answer() {
  const bus::Participant participant(place("answers"));
  bus::Reader<wire::ChannelReport> reports(participant);
  bus::Writer<wire::HeightCommand> commands(participant, {.strength = 10});
  bus::Waiter waiter;
  waiter.add(reports);
  std::thread([&] {
    for (;; std::this_thread::sleep_for(100ms)) commands.assert_liveliness();
  }).detach();
  for (;;) {
    waiter.wait(100ms);
    reports.drain([&](const wire::ChannelReport& report) {
      wire::HeightCommand command;
      command.stream(report.stream());
      command.attempt(report.attempt());
      command.step(1);
      command.agent(report.agent());
      command.action(wire::ACTION_HOLD);
      commands.write(command);
    });
  }
}

/// Runs `work` in a process of its own.
class Child {
 public:
  template <class Work>
  explicit Child(Work work) : test_(getpid()), pid_(fork()) {
    if (pid_ != 0) return;
    test::die_with(test_);
    work();
  }
  ~Child() {
    kill(pid_, SIGKILL);
    waitpid(pid_, nullptr, 0);
  }
  Child(const Child&) = delete;
  Child& operator=(const Child&) = delete;
  void send(int signal) const { kill(pid_, signal); }

 private:
  pid_t test_;
  pid_t pid_;
};

}  // namespace

TEST_CASE("processes that stood still find each other again", "[standstill]") {
  void* shared =
      mmap(nullptr, sizeof(std::atomic<std::uint32_t>), PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
  REQUIRE(shared != MAP_FAILED);
  auto& steps = *new (shared) std::atomic<std::uint32_t>(0);
  const Child asks([&] { ask(steps); });
  const Child answers([] { answer(); });
  const auto goes_on = [&] {
    const std::uint32_t before = steps;
    return test::eventually(10s, [&] { return steps > before + 10; });
  };
  REQUIRE(goes_on());
  RandomStream random(3, 0, "standstill");
  for (int round = 0; round < test::effort(12, 300); ++round) {
    const bool first = round % 3 != 1;
    const bool second = round % 3 != 0;
    const auto time = std::chrono::microseconds(300'000 + random.uniform_index(2'000'000));
    const auto lag = std::chrono::microseconds(random.uniform_index(200'000));
    INFO("round " << round << ": " << (first ? "who asks " : "") << (second ? "who answers " : "")
                  << "stands still for " << time.count() << " us");
    if (first) asks.send(SIGSTOP);
    if (second) answers.send(SIGSTOP);
    std::this_thread::sleep_for(time);
    (round % 2 == 0 ? asks : answers).send(SIGCONT);
    std::this_thread::sleep_for(lag);
    (round % 2 == 0 ? answers : asks).send(SIGCONT);
    REQUIRE(goes_on());
  }
  munmap(shared, sizeof steps);
}

}  // namespace aloft
