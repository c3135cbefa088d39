#include "services/environment/environment.hpp"

#include <spdlog/spdlog.h>

#include <chrono>
#include <deque>
#include <optional>

#include "common/bus/endpoint.hpp"
#include "common/bus/waiter.hpp"
#include "common/experiment/experiment.hpp"
#include "services/environment/world_maker.hpp"

namespace aloft::environment {
namespace {

using Clock = std::chrono::steady_clock;

constexpr std::chrono::milliseconds wait_limit{200};
constexpr std::chrono::seconds missing_after{3};
constexpr std::size_t max_queue = 256;

}  // namespace

struct Environment::State {
  State(const bus::BusOptions& place, bus::StopSignal& stop_signal)
      : stop(stop_signal), participant(place), waiter(stop_signal) {
    waiter.add(controls);
    waiter.add(assignments);
  }

  void run() {
    while (!stop.requested() && !over) {
      waiter.wait(wait_limit);
      controls.drain([this](const wire::RunControl& control) { on_control(control); });
      if (!experiment) continue;
      assignments.drain([this](const wire::TrialAssignment& assignment) { on_assignment(assignment); });
      serve();
    }
  }

  void on_control(const wire::RunControl& control) {
    over = control.state() != wire::RUN_RUNNING;
    if (over) spdlog::info("the run is over");
    if (over || (experiment && control.experiment_id() == experiment->id)) return;
    experiment.emplace(experiment::parse(wire::view(control.experiment_json()), "the experiment of the run"));
    assignments.expect_experiment(experiment->id);
    maker.emplace(*experiment);
    queue.clear();
    spdlog::info("experiment {} ({})", experiment->name, experiment->id);
  }

  void on_assignment(const wire::TrialAssignment& assignment) {
    if (assignment.worker() != participant.options().worker) return;
    if (queue.size() == max_queue) queue.pop_front();  // its lease will be taken back
    queue.push_back(assignment);
  }

  /// A world that nobody hears would be lost, so the channel must be there first.
  void serve() {
    if (queue.empty()) return;
    if (worlds.matched() == 0) return tell_missing();
    missing_since.reset();
    told_missing = false;
    for (; !queue.empty() && !stop.requested(); queue.pop_front()) {
      wire::World world = maker->make(queue.front());
      worlds.write(world);
    }
  }

  void tell_missing() {
    if (!missing_since) missing_since = Clock::now();
    if (told_missing || Clock::now() - *missing_since < missing_after) return;
    told_missing = true;
    spdlog::warn("waits for aloft-channel of worker {}; {} trials wait for it", participant.options().worker,
                 queue.size());
  }

  bus::StopSignal& stop;
  bus::Participant participant;
  bus::Reader<wire::RunControl> controls{participant};
  bus::Reader<wire::TrialAssignment> assignments{participant};
  bus::Writer<wire::World> worlds{participant};
  bus::Waiter waiter;

  std::optional<experiment::Experiment> experiment;
  std::optional<WorldMaker> maker;
  std::deque<wire::TrialAssignment> queue;
  std::optional<Clock::time_point> missing_since;
  bool told_missing = false;
  bool over = false;
};

Environment::Environment(const bus::BusOptions& place, bus::StopSignal& stop)
    : state_(std::make_unique<State>(place, stop)) {}

Environment::~Environment() = default;

void Environment::run() {
  state_->run();
}

}  // namespace aloft::environment
