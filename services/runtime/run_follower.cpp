#include "services/runtime/run_follower.hpp"

#include <spdlog/spdlog.h>

#include "common/base/plain_text.hpp"

namespace aloft::runtime {
namespace {

constexpr std::size_t longest_reason = 500;
constexpr std::size_t senders_told = 64;

}  // namespace

bool RunFollower::update() {
  const bool known_before = experiment_ != nullptr;
  controls_.drain([this](const wire::RunControl& control) { follow(control); });
  return !known_before && experiment_ != nullptr;
}

void RunFollower::follow(const wire::RunControl& control) {
  if (control.state() != wire::RUN_RUNNING) {
    if (!over_) spdlog::info("the run is over");
    over_ = true;
    return;
  }
  if (experiment_ != nullptr) {
    collector_ = control.collector().incarnation();
    return;
  }
  try {
    auto experiment = std::make_shared<experiment::Experiment>(
        experiment::parse(wire::view(control.experiment_json()), "the experiment of the run"));
    if (control.experiment_id() != experiment->id) return controls_.drop("the experiment has another id");
    controls_.expect_experiment(experiment->id);
    spdlog::info("experiment {} ({}): {} agents", experiment->name, experiment->id, experiment->agents.size());
    experiment_ = std::move(experiment);
    collector_ = control.collector().incarnation();
  } catch (const std::exception& error) {
    refuse(error.what());
  }
}

void RunFollower::refuse(std::string_view reason) {
  if (refused_senders_.size() < senders_told && refused_senders_.insert(controls_.sender()).second)
    spdlog::error("cannot fly the experiment that {} offers: {}", controls_.sender(),
                  plain_text(reason, longest_reason));
  controls_.drop("the experiment cannot be read");
}

}  // namespace aloft::runtime
