// One or both of two processes on the bus are stopped for a while: they must find each other again.
#include <signal.h>
#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <catch2/catch.hpp>
#include <chrono>
#include <memory>
#include <thread>
#include <vector>

#include "common/base/random.hpp"
#include "common/bus/endpoint.hpp"
#include "common/bus/waiter.hpp"
#include "tests/faults/effort.hpp"
#include "tests/faults/fault_scene.hpp"

namespace aloft {
namespace {

using namespace std::chrono_literals;
using Clock = std::chrono::steady_clock;

/// `lease`: how long peers remember this process while it is silent.
bus::BusOptions place(const char* process, std::chrono::milliseconds lease) {
  bus::BusOptions options;
  options.lease = lease;
  options.run = "standstill-" + std::to_string(getpgrp());
  options.worker = "w0";
  options.process = process;
  options.domain = 10 + getpgrp() % 90;
  return options;
}

/// Asks for the next step until it is commanded, again every 100 ms; counts the steps.
[[noreturn]] void ask(std::uint32_t stream, std::atomic<std::uint32_t>& steps, std::chrono::milliseconds lease) {
  const bus::Participant participant(place("asks", lease));
  bus::Writer<wire::ChannelReport> reports(participant);
  bus::Reader<wire::HeightCommand> commands(participant);
  bus::Waiter waiter;
  waiter.add(commands);
  wire::ChannelReport report;
  report.stream(stream);
  report.agent(wire::name("agent"));
  report.height_step_m(10);
  report.steps(1);
  for (std::uint32_t attempt = 1;; ++attempt) {
    report.attempt(attempt);
    for (bool answered = false; !answered;) {
      reports.write(report);
      waiter.wait(100ms);
      commands.drain([&](const wire::HeightCommand& command) {
        answered = answered || (command.stream() == stream && command.attempt() == attempt);
      });
    }
    ++steps;
  }
}

[[noreturn]] void answer(std::chrono::milliseconds lease) {
  const bus::Participant participant(place("answers", lease));
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

/// Counters in memory shared by several processes.
template <std::size_t count>
class SharedSteps {
 public:
  SharedSteps() {
    void* shared = mmap(nullptr, sizeof *steps_, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
    REQUIRE(shared != MAP_FAILED);
    steps_ = new (shared) std::array<std::atomic<std::uint32_t>, count>();
  }
  ~SharedSteps() { munmap(steps_, sizeof *steps_); }
  SharedSteps(const SharedSteps&) = delete;
  SharedSteps& operator=(const SharedSteps&) = delete;
  std::atomic<std::uint32_t>& operator[](std::size_t i) { return steps_->at(i); }

  /// Waits until every counter has advanced.
  bool go_on() {
    std::array<std::uint32_t, count> before{};
    for (std::size_t i = 0; i < count; ++i) before.at(i) = steps_->at(i);
    return test::eventually(60s, [&] {
      for (std::size_t i = 0; i < count; ++i)
        if (steps_->at(i) <= before.at(i) + 10) return false;
      return true;
    });
  }

 private:
  std::array<std::atomic<std::uint32_t>, count>* steps_ = nullptr;
};

}  // namespace

TEST_CASE("processes that were stopped find each other again", "[standstill]") {
  SharedSteps<1> steps;
  const Child asks([&] { ask(0, steps[0], 1s); });
  const Child answers([] { answer(1s); });
  REQUIRE(steps.go_on());
  RandomStream random(3, 0, "standstill");
  for (int round = 0; round < test::effort(12, 300); ++round) {
    const bool first = round % 3 != 1;
    const bool second = round % 3 != 0;
    const auto time = std::chrono::microseconds(300'000 + random.uniform_index(2'000'000));
    const auto lag = std::chrono::microseconds(random.uniform_index(200'000));
    INFO("round " << round << ": " << (first ? "the asker " : "") << (second ? "the answerer " : "")
                  << "is stopped for " << time.count() << " us");
    if (first) asks.send(SIGSTOP);
    if (second) answers.send(SIGSTOP);
    std::this_thread::sleep_for(time);
    (round % 2 == 0 ? asks : answers).send(SIGCONT);
    std::this_thread::sleep_for(lag);
    (round % 2 == 0 ? answers : asks).send(SIGCONT);
    REQUIRE(steps.go_on());
  }
}

TEST_CASE("many peers forget a process that remembers them: they find it again", "[standstill]") {
  constexpr std::size_t askers = 5;
  SharedSteps<askers> steps;
  std::vector<std::unique_ptr<Child>> asking;
  for (std::size_t i = 0; i < askers; ++i)
    asking.push_back(std::make_unique<Child>([&] { ask(static_cast<std::uint32_t>(i), steps[i], 200s); }));
  const Child answers([] { answer(300ms); });
  REQUIRE(steps.go_on());
  for (int round = 0; round < test::effort(8, 100); ++round) {
    INFO("round " << round);
    answers.send(SIGSTOP);
    std::this_thread::sleep_for(600ms);
    // The peers continue one by one: the answer to one of them must not disturb those that have not asked yet.
    for (const auto& one : asking) one->send(SIGSTOP);
    answers.send(SIGCONT);
    std::this_thread::sleep_for(20ms);
    for (const auto& one : asking) {
      one->send(SIGCONT);
      std::this_thread::sleep_for(20ms);
    }
    REQUIRE(steps.go_on());
  }
}

}  // namespace aloft
