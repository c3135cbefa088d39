#include "python/src/fleet.hpp"

#include <algorithm>
#include <limits>
#include <stdexcept>
#include <utility>

#include "common/base/cores.hpp"
#include "common/base/error.hpp"

namespace aloft::python {
namespace {

constexpr std::uint32_t max_environments = 65'536;
constexpr std::uint32_t max_threads = 1'024;
constexpr std::size_t max_values = std::size_t{1} << 28U;  // of all observations together, and of all foresight

Fleet::Settings checked(Fleet::Settings settings) {
  check_range("num_envs", settings.environments, 1, max_environments);
  check_range("num_threads", settings.threads, 0, max_threads);
  check(settings.layout);
  if (settings.environments * settings.layout.size() > max_values)
    throw InputError("{} environments x {} values are too large for one observation; use at most {} values together",
                     settings.environments, settings.layout.size(), max_values);
  if (settings.threads == 0) settings.threads = std::min(usable_cores(), max_threads);
  settings.threads = std::min(settings.threads, settings.environments);
  return settings;
}

}  // namespace

Fleet::Turn::Turn(std::atomic_flag& busy) : busy_(busy) {
  if (busy_.test_and_set(std::memory_order_acquire))
    throw std::runtime_error("another thread is using this environment; give each thread its own");
}

Fleet::Fleet(std::shared_ptr<const Worlds> worlds, const Settings& settings)
    : settings_(checked(settings)), worlds_(std::move(worlds)), team_(settings_.threads) {
  environments_.reserve(size());
  for (std::uint32_t i = 0; i < size(); ++i) environments_.emplace_back(worlds_, layout());
  columns_.observation.resize(size() * layout().size());
  if (settings_.autoreset == Autoreset::same_step) columns_.final_observation.resize(columns_.observation.size());
  columns_.number.resize(std::size_t{numbers} * size());
  columns_.integer.resize(std::size_t{integers} * size());
  columns_.flag.resize(std::size_t{flags} * size());
  if (settings_.foresight == Foresight::none) return;
  const auto map = worlds_->map(0, 0, 0);
  columns_.profile_steps = settings_.foresight == Foresight::whole_route ? map->steps() : 1;
  columns_.profile_heights = map->heights().size();
  const std::size_t values = std::size_t{columns_.profile_steps} * columns_.profile_heights * size();
  if (values > max_values)
    throw InputError(
        "{} environments x {} steps x {} heights are too much foresight; use at most {} values together, or "
        "a greater height_resolution_m",
        size(), columns_.profile_steps, columns_.profile_heights, max_values);
  columns_.profile.resize(values);
  check_conditions();
}

/// Every condition must have room for its foresight.
void Fleet::check_conditions() const {
  const bool whole = settings_.foresight == Foresight::whole_route;
  for (std::uint32_t i = 1; i < worlds_->conditions().size(); ++i) {
    const auto map = worlds_->map(i, 0, 0);
    if (map->heights().size() != columns_.profile_heights || (whole && map->steps() != columns_.profile_steps))
      throw InputError(
          "condition {} has {} steps and {} heights, but condition 0 has others; with foresight all conditions "
          "must have the same",
          i, map->steps(), map->heights().size());
  }
}

std::span<float> Fleet::observation_of(std::vector<float>& all, std::uint32_t index) const {
  return std::span(all).subspan(index * layout().size(), layout().size());
}

void Fleet::reset(std::span<const Start> starts, std::span<const std::uint8_t> chosen) {
  const Turn turn(busy_);
  if (starts.size() != size() || chosen.size() != size()) throw std::logic_error("one start per environment");
  for (const Start& start : starts)
    if (start.condition >= worlds_->conditions().size())
      throw InputError("condition: {} is not allowed; use a whole number from 0 to {}", start.condition,
                       worlds_->conditions().size() - 1);
  std::ranges::fill(std::span(columns_.flag).subspan(std::size_t{stepped} * size()), std::uint8_t{0});
  team_.run(size(), [&](std::size_t i) {
    if (chosen[i] != 0) begin_one(static_cast<std::uint32_t>(i), starts[i]);
  });
}

void Fleet::begin_one(std::uint32_t index, const Start& start) {
  environments_[index].begin(start);
  at(terminated, index) = 0;
  write_start(index);
  write_foresight(index);
  environments_[index].write_observation(observation_of(columns_.observation, index));
}

void Fleet::begin_next(std::uint32_t index) {
  Start next = environments_[index].start();
  if (next.trial == std::numeric_limits<std::uint32_t>::max())
    throw InputError("there is no trial after {}; reset with another seed", next.trial);
  ++next.trial;
  environments_[index].begin(next);
  write_start(index);
  write_foresight(index);
}

const Environment& Fleet::environment(std::uint32_t index) const {
  if (index >= size()) throw InputError("there is no environment {}; use 0 to {}", index, size() - 1);
  if (!environments_[index].begun()) throw std::runtime_error("no flight has begun; call reset() first");
  return environments_[index];
}

void Fleet::check_action(std::uint32_t index, std::int64_t action) const {
  if (environment(index).flight().finished()) {
    if (settings_.autoreset == Autoreset::next_step) return;  // the action is ignored
    throw std::runtime_error("the flight is at its end; call reset() before the next step()");
  }
  if (action < 0 || action > 2) throw InputError("action: {} is not allowed; use 0 (down), 1 (hold) or 2 (up)", action);
}

void Fleet::step(std::span<const std::int64_t> actions) {
  const Turn turn(busy_);
  if (actions.size() != size())
    throw InputError("{} actions for {} environments; give one each", actions.size(), size());
  for (std::uint32_t i = 0; i < size(); ++i) check_action(i, actions[i]);
  team_.run(size(), [&](std::size_t i) { step_one(static_cast<std::uint32_t>(i), actions[i]); });
}

void Fleet::step_one(std::uint32_t index, std::int64_t action) {
  Environment& environment = environments_[index];
  at(began, index) = 0;
  at(foreseen, index) = 0;
  if (environment.flight().finished()) {
    for (std::uint8_t column = 0; column < numbers; ++column) at(Number(column), index) = 0.0;
    at(serving_cell, index) = 0;
    at(executed, index) = 0;
    for (const Flag flag : {handover, terminated, stepped}) at(flag, index) = 0;
    begin_next(index);
  } else {
    environment.step(static_cast<agents::Action>(action + static_cast<std::int64_t>(agents::Action::down)));
    write_step(index);
    if (environment.flight().finished() && settings_.autoreset == Autoreset::same_step) {
      environment.write_observation(observation_of(columns_.final_observation, index));
      begin_next(index);
    } else {
      write_foresight(index);
    }
  }
  environment.write_observation(observation_of(columns_.observation, index));
}

void Fleet::write_start(std::uint32_t index) {
  const Environment& environment = environments_[index];
  at(began, index) = 1;
  at(seed, index) = static_cast<std::int64_t>(environment.start().seed);
  at(trial, index) = environment.start().trial;
  at(condition, index) = environment.start().condition;
  at(steps, index) = environment.flight().info().steps;
}

void Fleet::write_step(std::uint32_t index) {
  const Environment& environment = environments_[index];
  const flight::StepRecord& last = environment.flight().record().steps.back();
  at(reward, index) = last.reward;
  at(height_m, index) = last.height_m;
  at(x_m, index) = last.x_m;
  at(y_m, index) = last.y_m;
  at(qos, index) = last.qos;
  at(energy_j, index) = environment.energy_j();
  at(serving_cell, index) = last.serving_cell;
  at(executed, index) = static_cast<std::int64_t>(last.action) - static_cast<std::int64_t>(agents::Action::down);
  at(handover, index) = environment.handover() ? 1 : 0;
  at(terminated, index) = environment.flight().finished() ? 1 : 0;
  at(stepped, index) = 1;
}

void Fleet::write_foresight(std::uint32_t index) {
  const flight::Flight& flight = environments_[index].flight();
  if (settings_.foresight == Foresight::none || flight.finished()) return;
  const std::uint32_t next = flight.observation().step + 1;
  if (settings_.foresight == Foresight::whole_route && next > 1) return;  // told already
  agents::HeightProfile profile;
  for (std::uint32_t row = 0; row < columns_.profile_steps; ++row) {
    flight.profile(next + row, profile);
    write_profile(index, profile, row);
  }
  at(foreseen, index) = 1;
}

void Fleet::write_profile(std::uint32_t index, const agents::HeightProfile& profile, std::uint32_t row) {
  const std::size_t at = (std::size_t{index} * columns_.profile_steps + row) * columns_.profile_heights;
  std::ranges::copy(profile.qos, columns_.profile.begin() + static_cast<std::ptrdiff_t>(at));
}

}  // namespace aloft::python
