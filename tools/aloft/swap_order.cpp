#include "tools/aloft/swap_order.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <chrono>
#include <random>
#include <set>

#include "common/base/error.hpp"
#include "common/base/nearest.hpp"
#include "common/base/plain_text.hpp"
#include "common/bus/endpoint.hpp"
#include "common/bus/waiter.hpp"

namespace aloft::cli {
namespace {

using Clock = std::chrono::steady_clock;

constexpr std::chrono::milliseconds ask_again{500};
constexpr std::chrono::seconds find_limit{5};  // workers publish their status every 0.5 s

class Swap {
 public:
  Swap(const SwapOrder& options, StopSignal& stop)
      : options_(options), stop_(stop), participant_(options.place), waiter_(stop) {
    waiter_.add(workers_);
    waiter_.add(replies_);
    request_.request_id(std::random_device()() + (std::uint64_t{std::random_device()()} << 32U));
    request_.agent(wire::name(options.agent));
    request_.from_step(options.at_step);
  }

  std::string run() {
    find_worker();
    wait_for_reply();
    return stop_.requested() ? "" : outcome();
  }

 private:
  /// Handles what comes until `done` or the limit; false if the time ran out.
  template <typename Done>
  bool wait_until(Clock::time_point limit, Done done) {
    while (!done()) {
      if (stop_.requested()) return true;
      if (Clock::now() >= limit) return false;
      waiter_.wait(std::chrono::milliseconds(100));
      workers_.drain([this](const wire::WorkerStatus& status) {
        if (status.capacity() > 0) seen_.insert(plain_text(wire::view(status.worker())));
      });
      replies_.drain([this](const wire::SwapReply& reply) {
        if (reply.request_id() == request_.request_id()) reply_ = reply;
      });
    }
    return true;
  }

  void find_worker() {
    const std::string& worker = options_.place.worker;
    if (wait_until(Clock::now() + find_limit,
                   [&] { return seen_.contains(worker) && requests_.matched() > 0 && replies_.matched() > 0; }))
      return;
    const std::vector<std::string> names(seen_.begin(), seen_.end());
    if (names.empty())
      throw InputError("nobody flies in run '{}' on domain {}; name a run with: aloft run ... --run {} --domain {}",
                       options_.place.run, options_.place.domain, options_.place.run, options_.place.domain);
    if (!seen_.contains(worker))
      throw InputError("run '{}' has no worker '{}'.{} Its workers: {}", options_.place.run, worker,
                       did_you_mean(worker, names), fmt::join(names, ", "));
    throw std::runtime_error(
        fmt::format("the channel of worker '{}' was not reached within {} s; see its log", worker, find_limit.count()));
  }

  /// Waits until the agent commands every flight that it was ordered to; with --at-step, until the order is accepted.
  void wait_for_reply() {
    const auto limit = Clock::now() + std::chrono::seconds(options_.limit_s);
    const auto done = [this] {
      return reply_.request_id() != 0 && (!reply_.accepted() || options_.at_step > 0 || reply_.flights_waiting() == 0);
    };
    while (true) {
      requests_.write(request_);
      if (wait_until(std::min(limit, Clock::now() + ask_again), done)) return;
      if (Clock::now() < limit) continue;
      if (reply_.request_id() == 0)
        throw std::runtime_error(fmt::format("the channel of worker '{}' did not answer within {} s; see its log",
                                             options_.place.worker, options_.limit_s));
      throw std::runtime_error(fmt::format(
          "worker '{}' took the order, but waits for agent '{}' in {} flights since {} s; see the log of the process "
          "that hosts it",
          options_.place.worker, options_.agent, reply_.flights_waiting(), options_.limit_s));
    }
  }

  [[nodiscard]] std::string outcome() const {
    const std::string& worker = options_.place.worker;
    if (!reply_.accepted()) throw InputError("worker '{}': {}", worker, plain_text(wire::view(reply_.message())));
    const std::uint32_t flights = reply_.flights_waiting() + reply_.flights_flown();
    if (flights == 0)
      return fmt::format("worker {} has no such flight in the air; {} flies those that start later{}", worker,
                         options_.agent,
                         options_.at_step > 0 ? fmt::format(", from step {} on", options_.at_step) : "");
    return fmt::format("{} flies {} of worker {} {}, and those that start later", options_.agent,
                       flights == 1 ? "the 1 flight in the air" : fmt::format("the {} flights in the air", flights),
                       worker, options_.at_step > 0 ? fmt::format("from step {} on", options_.at_step) : "from now on");
  }

  const SwapOrder& options_;
  StopSignal& stop_;
  bus::Participant participant_;
  bus::Reader<wire::WorkerStatus> workers_{participant_};
  bus::Writer<wire::SwapRequest> requests_{participant_};
  bus::Reader<wire::SwapReply> replies_{participant_};
  bus::Waiter waiter_;
  std::set<std::string> seen_;
  wire::SwapRequest request_;
  wire::SwapReply reply_;
};

}  // namespace

std::string order_swap(SwapOrder order, StopSignal& stop) {
  order.place.process = "aloft-swap";
  order.place.role = security::Role::run_operator;
  return Swap(order, stop).run();
}

}  // namespace aloft::cli
