// Flights per second of `aloft run` with one worker on one core and with two workers on two cores, in turns: with DQN
// flights, where learning takes nearly all the time, and without, where DDS does. Takes three minutes.
// Usage: scaling [DOMAIN [TURNS]]; needs the executables of aloft beside it.
#include <fmt/format.h>
#include <spdlog/spdlog.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <fstream>
#include <map>
#include <string>
#include <thread>
#include <vector>

#include "bench/pinned_process.hpp"
#include "bench/scene.hpp"
#include "common/base/cores.hpp"
#include "common/base/error.hpp"
#include "common/bus/endpoint.hpp"
#include "common/bus/waiter.hpp"

namespace {

using namespace aloft;
using namespace std::chrono_literals;
using Clock = std::chrono::steady_clock;

constexpr auto start_limit = 30s;
constexpr auto warm_up = 3s;
constexpr auto measured_time = 10s;
constexpr double steps_per_flight = 100.0;

struct Kind {
  const char* name;
  const char* agents;
};
constexpr std::array kinds{
    Kind{"DQN", R"(["dqn"])"},
    Kind{"without a learner", R"(["min-height", "constant-60", "constant-120", "random-walk", "one-step-ahead",
                                  "optimal-height", "planner"])"}};

/// What the workers of a run have flown since they started.
class Listener {
 public:
  explicit Listener(const bus::BusOptions& place) : participant_(place) { waiter_.add(statuses_); }

  void listen_until(Clock::time_point time) {
    for (auto now = Clock::now(); now < time; now = Clock::now()) {
      waiter_.wait(std::chrono::ceil<std::chrono::milliseconds>(time - now));
      statuses_.drain([this](const wire::WorkerStatus& status) {
        steps_[std::string(wire::view(status.worker()))] = {status.steps_done(), Clock::now()};
      });
    }
  }
  [[nodiscard]] bool all_fly(std::size_t workers) const {
    return steps_.size() == workers &&
           std::all_of(steps_.begin(), steps_.end(), [](const auto& worker) { return worker.second.first > 0; });
  }
  /// Steps of every worker, with the time of its status.
  [[nodiscard]] const auto& steps() const noexcept { return steps_; }

 private:
  bus::Participant participant_;
  bus::Reader<wire::WorkerStatus> statuses_{participant_};
  bus::Waiter waiter_;
  std::map<std::string, std::pair<std::uint64_t, Clock::time_point>> steps_;
};

double flights_per_s(const Kind& kind, unsigned workers, int domain) {
  const bench::Folder scratch;
  const std::string experiment = (scratch.path / "experiment.json").string();
  std::ofstream(experiment) << R"({"name": "scaling", "trials": 100000, "world": {"kind": "generated",
    "bs_density_per_km2": 2.5, "building_density_per_km2": 200}, "agents": )"
                            << kind.agents << "}";
  static int number = 0;
  const bus::BusOptions place{
      .run = fmt::format("scaling-{}-{}", getpid(), number++), .worker = "", .process = "scaling", .domain = domain};
  Listener listener(place);
  const std::string log = (scratch.path / "log").string();
  const bench::PinnedProcess run(workers == 1 ? "0" : "0,1", "aloft",
                                 {"run", experiment, "--workers", std::to_string(workers), "--run", place.run,
                                  "--domain", std::to_string(domain), "--out", (scratch.path / "out").string()},
                                 log);
  const auto limit = Clock::now() + start_limit;
  while (!listener.all_fly(workers)) {
    if (Clock::now() > limit) {
      std::ifstream text(log);
      throw std::runtime_error(fmt::format("not all of {} workers fly after {} s: {}", workers, start_limit.count(),
                                           std::string(std::istreambuf_iterator<char>(text), {})));
    }
    listener.listen_until(Clock::now() + 100ms);
  }
  listener.listen_until(Clock::now() + warm_up);
  const auto before = listener.steps();
  listener.listen_until(Clock::now() + measured_time);
  double rate = 0.0;
  for (const auto& [worker, after] : listener.steps()) {
    const auto& [steps, at] = before.at(worker);
    rate += static_cast<double>(after.first - steps) / std::chrono::duration<double>(after.second - at).count();
  }
  return rate / steps_per_flight;
}

void measure(const Kind& kind, int domain, int turns) {
  std::vector<double> one;
  std::vector<double> two;
  std::vector<double> ratios;
  for (int turn = 0; turn < turns; ++turn) {
    one.push_back(flights_per_s(kind, 1, domain));
    two.push_back(flights_per_s(kind, 2, domain));
    ratios.push_back(two.back() / one.back());
  }
  const auto median = [](std::vector<double> values) {
    std::sort(values.begin(), values.end());
    return values[values.size() / 2];
  };
  fmt::print("{:<18} {:>14.2f} {:>14.2f} {:>8.2f}  ({:.2f})\n", kind.name, median(one), median(two), median(ratios),
             fmt::join(ratios, ", "));
  std::fflush(stdout);
}

}  // namespace

int main(int argc, char** argv) {
  spdlog::set_level(spdlog::level::err);
  try {
    if (usable_cores() < 2) throw InputError("scaling needs two cores");
    const int domain = argc > 1 ? std::stoi(argv[1]) : 59;
    const int turns = argc > 2 ? std::stoi(argv[2]) : 3;
    fmt::print("{:<18} {:>14} {:>14} {:>8}\n", "flights per s", "1 on 1 core", "2 on 2 cores", "ratio");
    for (const Kind& kind : kinds) measure(kind, domain, turns);
    return exit_ok;
  } catch (const std::exception& error) {
    fmt::print(stderr, "scaling: {}\n", error.what());
    return exit_failure;
  }
}
