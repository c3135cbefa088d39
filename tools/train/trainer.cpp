#include "tools/train/trainer.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "common/agents/pretrained_model.hpp"
#include "common/base/random.hpp"
#include "tools/train/parallel.hpp"

namespace aloft::train {
namespace {

using agents::PretrainedState;
using agents::QosKind;

constexpr std::size_t worlds_per_item = 16;
constexpr std::array<double, 5> densities = {1.0, 1.7, 2.5, 3.5, 5.0};  // base stations per km2
constexpr std::array<double, 3> held_out_densities = {1.0, 2.5, 5.0};
constexpr std::uint32_t held_out_trials = 1'000'000;  // trials from here on are never trained on

std::uint64_t seed_of(const Parameters& settings) {
  return static_cast<std::uint64_t>(settings.integer("seed"));
}

Field make_field(QosKind kind, std::uint64_t seed, std::size_t i, std::span<const double> of, std::uint32_t first) {
  if (kind == QosKind::throughput) return random_throughput_field(seed, first + static_cast<std::uint32_t>(i));
  return generated_field(of[i % of.size()], seed, first + static_cast<std::uint32_t>(i / of.size()));
}

/// A stream of its own for every (round, world).
RandomStream stream_of(const Parameters& settings, std::uint32_t round, std::size_t world) {
  return {seed_of(settings), static_cast<std::uint32_t>(world), fmt::format("training flight {}", round)};
}

}  // namespace

Trainer::Trainer(QosKind kind, const Parameters& settings, unsigned threads, Log log)
    : kind_(kind),
      settings_(settings),
      threads_(threads),
      log_(std::move(log)),
      shape_(agents::pretrained_shape(static_cast<std::size_t>(settings.integer("hidden_width")))) {
  RandomStream random(seed_of(settings), 0, "initial weights");
  weights_ = learn::initial_state(shape_, random).weights;
  for (unsigned i = 0; i < threads; ++i) networks_.push_back(learn::make_network(shape_, {}));
  const auto count = [&](const char* name) { return static_cast<std::size_t>(settings.integer(name)); };
  fields_ = make_fields(count("worlds"), threads,
                        [&](std::size_t i) { return make_field(kind, seed_of(settings), i, densities, 0); });
  held_out_ = make_fields(count("validation_worlds"), threads, [&](std::size_t i) {
    return make_field(kind, seed_of(settings), i, held_out_densities, held_out_trials);
  });
}

std::vector<float> Trainer::train() {
  std::vector<float> best;
  double best_gain = -1e300;
  const auto rounds = static_cast<std::uint32_t>(settings_.integer("rounds"));
  for (std::uint32_t round = 0; round <= rounds; ++round) {
    rounds_.push_back(collect([&](GreedyPolicy& policy, std::size_t first, std::size_t last, Samples& to) {
      if (round == 0)
        imitate(first, last, to);
      else
        visit(round, policy, first, last, to);
    }));
    // What was imitated with full information is no value of a policy.
    if (round == 1 || rounds_.size() > static_cast<std::size_t>(settings_.integer("reused_rounds")))
      rounds_.erase(rounds_.begin());
    fit(round);
    const double gain = validate(round);
    if (gain <= best_gain) continue;
    best_gain = gain;
    best = weights_;
  }
  return best;
}

Samples Trainer::collect(const Collect& from) {
  for (const auto& network : networks_) network->load({weights_, {}, {}, 0});
  std::vector<Samples> parts((fields_.size() + worlds_per_item - 1) / worlds_per_item);
  for_each_item(parts.size(), threads_, [&](unsigned thread, std::size_t item) {
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
  constexpr std::size_t pieces = 100;  // of equal learning rate
  std::vector<std::pair<const Samples*, std::size_t>> where;
  for (const Samples& samples : rounds_)
    for (std::size_t i = 0; i < samples.size(); ++i) where.emplace_back(&samples, i);
  RandomStream random(seed_of(settings_), round, "minibatches");
  learn::NetworkState state{weights_, {}, {}, 0};
  learn::Minibatch batch{learn::batch_lanes, {}, {}, std::vector<float>(learn::batch_lanes * action_count, 1.0F)};
  const auto updates = static_cast<std::size_t>(settings_.integer("updates"));
  for (std::size_t piece = 0; piece < pieces; ++piece) {
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

double Trainer::validate(std::uint32_t round) {
  for (const auto& network : networks_) network->load({weights_, {}, {}, 0});
  std::vector<Validation> flights(held_out_.size());
  for_each_item(flights.size(), threads_, [&](unsigned thread, std::size_t i) {
    GreedyPolicy policy(*networks_[thread]);
    flights[i] = fly_held_out(i, policy);
  });
  const std::size_t groups = kind_ == QosKind::throughput ? 1 : held_out_densities.size();
  std::string text;
  double gain = 0.0;
  for (std::size_t group = 0; group < groups; ++group) {
    Validation mean;
    double count = 0.0;
    for (std::size_t i = group; i < flights.size(); i += groups, ++count) {
      mean.network += flights[i].network;
      mean.min_height += flights[i].min_height;
      mean.best += flights[i].best;
    }
    text +=
        fmt::format("  {}{:+.3f} of {:+.3f}", groups > 1 ? fmt::format("{} per km2: ", held_out_densities[group]) : "",
                    (mean.network - mean.min_height) / count, (mean.best - mean.min_height) / count);
    gain += (mean.network - mean.min_height) / count;
  }
  log_(fmt::format("{} round {}: gain over min-height of the best feasible{}",
                   kind_ == QosKind::throughput ? "throughput" : "spectral efficiency", round, text));
  return gain;
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
