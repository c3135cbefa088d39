#include "tools/train/trainer.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "common/agents/pretrained_model.hpp"
#include "common/agents/state_archive.hpp"
#include "common/agents/training_worlds.hpp"
#include "common/base/random.hpp"

namespace aloft::train {
namespace {

using agents::PretrainedState;
using radio::QosKind;

constexpr std::size_t worlds_per_item = 16;
// Base stations per km2.
constexpr std::array<double, 5> densities = {agents::training_worlds.bs_density_min_per_km2, 1.7, 2.5, 3.5,
                                             agents::training_worlds.bs_density_max_per_km2};
constexpr std::array<double, 3> held_out_densities = {densities.front(), 2.5, densities.back()};
constexpr std::uint32_t held_out_trials = 1'000'000;  // trials from here on are never trained on

std::uint64_t seed_of(const Parameters& settings) {
  return static_cast<std::uint64_t>(settings.integer("seed"));
}

Field make_field(QosKind kind, std::uint64_t seed, std::size_t i, std::span<const double> of, std::uint32_t first) {
  if (kind == QosKind::throughput) return random_throughput_field(seed, first + static_cast<std::uint32_t>(i));
  return generated_field(of[i % of.size()], seed, first + static_cast<std::uint32_t>(i / of.size()));
}

const char* name_of(QosKind kind) {
  return kind == QosKind::throughput ? "throughput" : "spectral efficiency";
}

std::string state_type(QosKind kind) {
  return fmt::format("training of {}", name_of(kind));
}

double total_gain(const std::vector<Validation>& groups) {
  double gain = 0.0;
  for (const Validation& group : groups) gain += group.network - group.min_height;
  return gain;
}

/// A stream of its own for every (round, world).
RandomStream stream_of(const Parameters& settings, std::uint32_t round, std::size_t world) {
  return {seed_of(settings), static_cast<std::uint32_t>(world), fmt::format("training flight {}", round)};
}

}  // namespace

Trainer::Trainer(QosKind kind, const Parameters& settings, unsigned threads, Watch watch)
    : kind_(kind),
      settings_(settings),
      threads_(threads),
      watch_(std::move(watch)),
      shape_(agents::pretrained_shape(static_cast<std::size_t>(settings.integer("hidden_width")))) {
  RandomStream random(seed_of(settings), 0, "initial weights");
  weights_ = learn::initial_state(shape_, random).weights;
  for (unsigned i = 0; i < threads; ++i) networks_.push_back(learn::make_network(shape_, {}));
  const auto make = [&](std::vector<Field>& to, const char* count, std::span<const double> of, std::uint32_t first) {
    to.resize(static_cast<std::size_t>(settings.integer(count)));
    for_each_item(to.size(), threads, watch_, "worlds", [&](unsigned /*thread*/, std::size_t i) {
      to[i] = make_field(kind, seed_of(settings), i, of, first);
    });
  };
  make(fields_, "worlds", densities, 0);
  make(held_out_, "validation_worlds", held_out_densities, held_out_trials);
}

bool Trainer::finished() const noexcept {
  return next_round_ > static_cast<std::uint32_t>(settings_.integer("rounds"));
}

std::string Trainer::phase(std::uint32_t round, const char* what) const {
  return fmt::format("round {} of {}: {}", round, settings_.integer("rounds"), what);
}

void Trainer::train_round() {
  const std::uint32_t round = next_round_;
  rounds_.push_back({round, weights_, samples_of(round)});
  // Samples of round 0 hold values with full information, which no policy reaches.
  if (round == 1 || rounds_.size() > static_cast<std::size_t>(settings_.integer("reused_rounds")))
    rounds_.erase(rounds_.begin());
  fit(round);
  validations_.push_back(validate(round));
  double most = -std::numeric_limits<double>::infinity();
  for (std::size_t before = 0; before + 1 < validations_.size(); ++before)
    most = std::max(most, total_gain(validations_[before]));
  if (total_gain(validations_.back()) > most) best_ = weights_;
  ++next_round_;
}

Samples Trainer::samples_of(std::uint32_t round) {
  return collect(round, [&](GreedyPolicy& policy, std::size_t first, std::size_t last, Samples& to) {
    if (round == 0)
      imitate(first, last, to);
    else
      visit(round, policy, first, last, to);
  });
}

Samples Trainer::collect(std::uint32_t round, const Collect& from) {
  for (const auto& network : networks_) network->load({weights_, {}, {}, 0});
  std::vector<Samples> parts((fields_.size() + worlds_per_item - 1) / worlds_per_item);
  for_each_item(parts.size(), threads_, watch_, phase(round, "flights"), [&](unsigned thread, std::size_t item) {
    GreedyPolicy policy(*networks_[thread]);
    const std::size_t first = item * worlds_per_item;
    from(policy, first, std::min(first + worlds_per_item, fields_.size()), parts[item]);
  });
  Samples all;
  for (const Samples& part : parts) all.append(part);
  return all;
}

void Trainer::imitate(std::size_t first, std::size_t last, Samples& to) const {
  const double discount = settings_.number("informed_discount");
  for (std::size_t world = first; world < last; ++world) {
    const Field& field = fields_[world];
    const std::vector<double> best = best_values(field, discount);
    RandomStream random = stream_of(settings_, 0, world);
    Walker walker(field);
    std::size_t action = random.uniform_index(action_count);
    while (!walker.finished()) {
      double values[action_count];
      for (std::size_t a = 0; a < action_count; ++a) {
        const std::uint32_t level = walker.level_after(a);
        values[a] = static_cast<double>(field.report(walker.step() + 1, level).qos) +
                    discount * best[(walker.step() + 1) * field.levels + level];
      }
      to.add(walker.state(), values);
      if (random.uniform() < 0.25) action = random.uniform_index(action_count);
      walker.fly(action);
    }
  }
}

void Trainer::visit(std::uint32_t round, GreedyPolicy& policy, std::size_t first, std::size_t last, Samples& to) const {
  struct Detour {
    std::size_t action = 1;
    std::uint32_t steps = 0;
  };
  const double random_share = settings_.number("random_share");
  const double state_share = settings_.number("state_share");
  std::vector<Walker> walkers;
  std::vector<RandomStream> random;
  std::vector<Walker> kept;
  for (std::size_t world = first; world < last; ++world) {
    walkers.emplace_back(fields_[world]);
    random.push_back(stream_of(settings_, round, world));
  }
  std::vector<Detour> detours(walkers.size());
  for (bool flying = true; flying;) {
    flying = false;
    const auto actions = policy.choose(walkers);
    for (std::size_t i = 0; i < walkers.size(); ++i) {
      if (walkers[i].finished()) continue;
      flying = true;
      if (random[i].uniform() < state_share) kept.push_back(walkers[i]);
      if (detours[i].steps == 0 && random[i].uniform() < random_share)
        detours[i] = {random[i].uniform_index(action_count), 1 + random[i].uniform_index(5)};
      if (detours[i].steps > 0) {
        --detours[i].steps;
        walkers[i].fly(detours[i].action);
      } else {
        walkers[i].fly(actions[i]);
      }
    }
  }
  const RolloutSettings rollout{settings_.number("rollout_discount"),
                                static_cast<std::uint32_t>(settings_.integer("rollout_steps"))};
  const std::vector<double> returns = roll_out(kept, policy, rollout);
  for (std::size_t i = 0; i < kept.size(); ++i)
    to.add(kept[i].state(), {returns[3 * i], returns[3 * i + 1], returns[3 * i + 2]});
}

void Trainer::fit(std::uint32_t round) {
  constexpr std::size_t pieces = 100;  // the learning rate is constant within each
  std::vector<std::pair<const Samples*, std::size_t>> where;
  for (const Round& source : rounds_)
    for (std::size_t i = 0; i < source.samples.size(); ++i) where.emplace_back(&source.samples, i);
  RandomStream random(seed_of(settings_), round, "minibatches");
  learn::NetworkState state{weights_, {}, {}, 0};
  learn::Minibatch batch{learn::batch_lanes, {}, {}, std::vector<float>(learn::batch_lanes * action_count, 1.0F)};
  const auto updates = static_cast<std::size_t>(settings_.integer("updates"));
  for (std::size_t piece = 0; piece < pieces; ++piece) {
    watch_.tell(phase(round, "fit"), static_cast<double>(piece) / static_cast<double>(pieces));
    const double done = (static_cast<double>(piece) + 0.5) / static_cast<double>(pieces);
    const double rate = settings_.number("learning_rate") * 0.5 * (1.0 + std::cos(std::numbers::pi * done));
    const auto network = learn::make_network(shape_, {.learning_rate = rate});
    network->load(state);
    for (std::size_t i = updates * piece / pieces; i < updates * (piece + 1) / pieces; ++i) {
      batch.inputs.clear();
      batch.targets.clear();
      for (std::size_t s = 0; s < batch.size; ++s) {
        const auto& [samples, at] = where[random.uniform_index(static_cast<std::uint32_t>(where.size()))];
        const auto row = [](const std::vector<float>& from, std::size_t width, std::size_t index) {
          return std::span(from).subspan(index * width, width);
        };
        const auto inputs = row(samples->inputs, PretrainedState::inputs, at);
        const auto targets = row(samples->targets, action_count, at);
        batch.inputs.insert(batch.inputs.end(), inputs.begin(), inputs.end());
        batch.targets.insert(batch.targets.end(), targets.begin(), targets.end());
      }
      network->train(batch, learn::Loss::mse, 1);
    }
    state = network->state();
  }
  weights_ = state.weights;
}

std::vector<Validation> Trainer::validate(std::uint32_t round) {
  for (const auto& network : networks_) network->load({weights_, {}, {}, 0});
  std::vector<Validation> flights(held_out_.size());
  for_each_item(flights.size(), threads_, watch_, phase(round, "validation"), [&](unsigned thread, std::size_t i) {
    GreedyPolicy policy(*networks_[thread]);
    flights[i] = fly_held_out(i, policy);
  });
  std::vector<Validation> groups(kind_ == QosKind::throughput ? 1 : held_out_densities.size());
  for (std::size_t group = 0; group < groups.size(); ++group) {
    Validation& mean = groups[group];
    double count = 0.0;
    for (std::size_t i = group; i < flights.size(); i += groups.size(), ++count) {
      mean.network += flights[i].network;
      mean.min_height += flights[i].min_height;
      mean.best += flights[i].best;
    }
    mean = {mean.network / count, mean.min_height / count, mean.best / count};
  }
  return groups;
}

std::vector<std::string> Trainer::validation_log() const {
  std::vector<std::string> lines;
  for (const std::vector<Validation>& groups : validations_) {
    std::string text;
    for (std::size_t group = 0; group < groups.size(); ++group)
      text += fmt::format(
          "  {}{:+.3f} of {:+.3f}", groups.size() > 1 ? fmt::format("{} per km2: ", held_out_densities.at(group)) : "",
          groups[group].network - groups[group].min_height, groups[group].best - groups[group].min_height);
    lines.push_back(
        fmt::format("{} round {}: gain over min-height of the best feasible{}", name_of(kind_), lines.size(), text));
  }
  return lines;
}

std::string Trainer::save_state() const {
  agents::StateWriter writer(state_type(kind_), settings_);
  writer.put("weights", std::span(weights_));
  writer.put("best", std::span(best_));
  std::vector<double> validations;
  for (const auto& groups : validations_)
    for (const Validation& group : groups)
      validations.insert(validations.end(), {group.network, group.min_height, group.best});
  writer.put("validations", std::span<const double>(validations));
  std::vector<std::int64_t> numbers;
  std::vector<float> weights;
  for (const Round& round : rounds_) {
    numbers.push_back(round.number);
    weights.insert(weights.end(), round.weights.begin(), round.weights.end());
  }
  writer.put("rounds", std::span<const std::int64_t>(numbers));
  writer.put("rounds_weights", std::span<const float>(weights));
  return writer.bytes();
}

void Trainer::restore_state(std::string_view bytes) {
  const agents::StateReader reader(bytes, state_type(kind_), settings_);
  const std::size_t groups = kind_ == QosKind::throughput ? 1 : held_out_densities.size();
  const std::span<const double> validations = reader.doubles("validations");
  const std::span<const std::int64_t> numbers = reader.integers("rounds");
  const std::span<const float> weights = reader.floats("rounds_weights");
  if (validations.size() % (3 * groups) != 0 || weights.size() != numbers.size() * weights_.size())
    reader.refuse("its parts do not fit each other");
  validations_.clear();
  for (std::size_t i = 0; i < validations.size(); i += 3) {
    if (i % (3 * groups) == 0) validations_.emplace_back();
    validations_.back().push_back({validations[i], validations[i + 1], validations[i + 2]});
  }
  next_round_ = static_cast<std::uint32_t>(validations_.size());
  best_.resize(weights_.size());
  reader.get("best", std::span(best_));
  // The state leaves out the samples, which are large and follow from the weights.
  rounds_.clear();
  for (std::size_t i = 0; i < numbers.size() && !finished(); ++i) {
    const auto own = weights.subspan(i * weights_.size(), weights_.size());
    weights_.assign(own.begin(), own.end());
    const auto number = static_cast<std::uint32_t>(numbers[i]);
    rounds_.push_back({number, weights_, samples_of(number)});
  }
  reader.get("weights", std::span(weights_));
}

Validation Trainer::fly_held_out(std::size_t world, GreedyPolicy& policy) const {
  const Field& field = held_out_[world];
  Validation sum;
  Walker walker(field);
  while (!walker.finished()) {
    sum.min_height += static_cast<double>(field.report(walker.step() + 1, 0).qos);
    sum.network += walker.fly(policy.choose({&walker, 1}).front());
  }
  const double steps = field.steps;
  return {sum.network / steps, sum.min_height / steps, best_values(field, 1.0).front() / steps};
}

}  // namespace aloft::train
