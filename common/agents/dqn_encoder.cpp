#include "common/agents/dqn_encoder.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "common/base/error.hpp"

namespace aloft::agents {
namespace {

constexpr double sinr_scale_db = 20.0;

double power_ratio(double db) {
  return std::pow(10.0, db / 10.0);
}

}  // namespace

void DqnEncoder::begin(const FlightInfo& flight) {
  flight_ = flight;
  moments_.clear();
}

void DqnEncoder::forget() noexcept {
  largest_sinr_ = 0.0;
  largest_reward_ = 0.0;
}

std::size_t DqnEncoder::sinrs() const noexcept {
  return flight_.qos == QosKind::spectral_efficiency ? 1 + settings_.neighbours : 1;
}

std::size_t DqnEncoder::inputs() const noexcept {
  return sinrs() + 1 + settings_.history * (sinrs() + 3);
}

void DqnEncoder::observe(const Observation& observation) {
  const std::size_t neighbours = sinrs() - 1;
  if (observation.neighbour_count < neighbours)
    throw InputError(
        "agent dqn: the report of step {} has {} neighbour cells, but the state needs {}; lower the agent's parameter "
        "'neighbours' (4 or 5) or let the world report more",
        observation.step, observation.neighbour_count, neighbours);
  Moment now;
  now.sinr_db.push_back(observation.serving_sinr_db);
  for (std::size_t i = 0; i < neighbours; ++i) now.sinr_db.push_back(observation.neighbour_sinr_db.at(i));
  const double range_m = flight_.height_max_m - flight_.height_min_m;
  now.height_m = observation.height_m;
  now.height = range_m > 0.0 ? (observation.height_m - flight_.height_min_m) / range_m : 0.0;
  for (const double sinr_db : now.sinr_db) largest_sinr_ = std::max(largest_sinr_, power_ratio(sinr_db));

  if (!moments_.empty()) {
    Moment& before = moments_.back();
    const double previous_reward = moments_.size() > 1 ? moments_[moments_.size() - 2].reward : 0.0;
    before.action = static_cast<double>((now.height_m > before.height_m) - (now.height_m < before.height_m));
    before.reward = in_learning_units(observation.reward, flight_.qos);
    before.gain = moments_.size() > 1 ? before.reward - previous_reward : 0.0;
    largest_reward_ = std::max(largest_reward_, before.reward);
  }
  if (complete()) moments_.erase(moments_.begin());
  moments_.push_back(std::move(now));
}

double DqnEncoder::scaled_sinr(double sinr_db) const {
  return settings_.input_scaling == InputScaling::db ? sinr_db / sinr_scale_db : power_ratio(sinr_db) / largest_sinr_;
}

double DqnEncoder::scaled_reward(const Moment& moment) const {
  switch (settings_.reward) {
    case Reward::absolute:
      return moment.reward;
    case Reward::scaled:
      return largest_reward_ > 0.0 ? moment.reward / largest_reward_ : 0.0;
    case Reward::difference:
      return moment.gain;
  }
  return 0.0;
}

std::vector<float> DqnEncoder::state() const {
  if (!complete()) throw std::logic_error("the DQN's history is not complete yet");
  std::vector<float> state;
  state.reserve(inputs());
  for (std::size_t i = moments_.size(); i-- > 0;) {
    const Moment& moment = moments_[i];
    for (const double sinr_db : moment.sinr_db) state.push_back(static_cast<float>(scaled_sinr(sinr_db)));
    state.push_back(static_cast<float>(moment.height));
    if (i + 1 == moments_.size()) continue;  // the present report has no action yet
    state.push_back(static_cast<float>(moment.action));
    state.push_back(static_cast<float>(scaled_reward(moment)));
  }
  return state;
}

float DqnEncoder::reward() const {
  if (moments_.size() < 2) throw std::logic_error("no step has been rewarded yet");
  return static_cast<float>(scaled_reward(moments_[moments_.size() - 2]));
}

void DqnEncoder::save(StateWriter& writer) const {
  std::vector<double> values;
  for (const Moment& moment : moments_) {
    values.insert(values.end(), moment.sinr_db.begin(), moment.sinr_db.end());
    values.insert(values.end(), {moment.height, moment.height_m, moment.action, moment.reward, moment.gain});
  }
  writer.put("encoder.moments", values);
  writer.put_number("encoder.largest_sinr", largest_sinr_);
  writer.put_number("encoder.largest_reward", largest_reward_);
}

void DqnEncoder::restore(const StateReader& reader) {
  const auto values = reader.doubles("encoder.moments");
  const std::size_t width = sinrs() + moment_values;
  if (values.size() % width != 0 || values.size() > width * (settings_.history + 1))
    reader.refuse(fmt::format("its history has {} values, not a multiple of {}", values.size(), width));
  moments_.clear();
  for (std::size_t at = 0; at < values.size(); at += width) {
    const auto rest = values.subspan(at + sinrs(), moment_values);
    const auto sinr_db = values.subspan(at, sinrs());
    moments_.push_back({{sinr_db.begin(), sinr_db.end()}, rest[0], rest[1], rest[2], rest[3], rest[4]});
  }
  largest_sinr_ = reader.number("encoder.largest_sinr");
  largest_reward_ = reader.number("encoder.largest_reward");
}

}  // namespace aloft::agents
