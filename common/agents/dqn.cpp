#include "common/agents/dqn.hpp"

#include <algorithm>

#include "common/agents/registry.hpp"
#include "common/base/error.hpp"
#include "common/base/limits.hpp"

namespace aloft::agents {
namespace {

DqnEncoder::Settings encoder_settings(const Parameters& parameters) {
  using InputScaling = DqnEncoder::InputScaling;
  using Reward = DqnEncoder::Reward;
  const std::string& reward = parameters.text("reward");
  return {
      .neighbours = static_cast<std::uint32_t>(parameters.integer("neighbours")),
      .history = static_cast<std::uint32_t>(parameters.integer("history")),
      .input_scaling = parameters.text("input_scaling") == "db" ? InputScaling::db : InputScaling::linear_max,
      .reward = reward == "absolute" ? Reward::absolute : (reward == "scaled" ? Reward::scaled : Reward::difference)};
}

std::size_t count_of(const Parameters& parameters, std::string_view name) {
  return static_cast<std::size_t>(parameters.integer(name));
}

template <typename Values>
std::size_t argmax(const Values& values) {
  return static_cast<std::size_t>(std::ranges::max_element(values) - values.begin());
}

learn::NetworkShape network_shape(const Parameters& parameters, std::size_t inputs) {
  return learn::dqn_shape(inputs, count_of(parameters, "hidden_width"), count_of(parameters, "hidden_layers"));
}

/// Upper bound of the size of Dqn::save_state: weights and two moments per network, and the replay memory.
std::size_t memory_bytes(const Parameters& parameters) {
  const std::size_t neighbours = count_of(parameters, "neighbours");
  const std::size_t inputs = neighbours + 2 + count_of(parameters, "history") * (neighbours + 4);
  const std::size_t networks = parameters.flag("target_network") ? 2 : 1;
  const std::size_t replay = count_of(parameters, "replay_capacity") * (2 * inputs + 6);
  constexpr std::size_t other_bytes = 8192;
  return (networks * 3 * network_shape(parameters, inputs).parameters() + replay) * sizeof(float) + other_bytes;
}

}  // namespace

std::span<const ParameterSpec> dqn_parameters() {
  static const std::vector<ParameterSpec> table{
      integer_parameter("neighbours", 4, 4, 5,
                        "Neighbour cells in the state of generated worlds: 4 published code, 5 paper's text."),
      integer_parameter("history", 4, 1, 8, "Past steps in the state; actions are random until they are known."),
      choice_parameter("input_scaling", "db", {"db", "linear-max"},
                       "SINR inputs: dB / 20, or power ratio / the largest seen."),
      choice_parameter("loss", "mse", {"mse", "cross-entropy"},
                       "mse: on the chosen action (textbook); cross-entropy: as published."),
      flag_parameter("target_network", true,
                     "Bootstrap from a copy of the network; the published code in effect has none."),
      choice_parameter("reward", "scaled", {"absolute", "scaled", "difference"},
                       "bit/s/Hz or Mbit/s; that / the largest seen; or its change."),
      choice_parameter("memory", "per-flight", {"per-flight", "lifelong"},
                       "Start afresh each flight, or keep network, optimiser, replay and epsilon."),
      integer_parameter("lineages", 1, 1, 10000,
                        "With lifelong memory: independent chains that the trials are dealt to."),
      number_parameter("learning_rate", 1e-3, 1e-6, 1.0, "Of Adam."),
      number_parameter("discount", 0.99, 0.0, 1.0, "Of future rewards, per step."),
      number_parameter("epsilon_start", 1.0, 0.0, 1.0, "Probability of a random action in the first step."),
      number_parameter("epsilon_decay", 0.9, 0.0, 1.0, "Factor on epsilon per step."),
      number_parameter("epsilon_floor", 0.05, 0.0, 1.0, "Lowest epsilon."),
      integer_parameter("replay_capacity", 100, 1, 100000, "Steps remembered."),
      integer_parameter("minibatch", 16, 1, learn::batch_lanes,
                        "Steps fitted at a time; training starts when so many are stored."),
      integer_parameter("epochs", 200, 1, 10000, "Gradient steps per step of the flight, all on the same minibatch."),
      integer_parameter("target_copy_steps", 5, 1, 10000, "Trainings between copies to the target network."),
      integer_parameter("hidden_width", 200, 8, 1024, "Units per ReLU layer, a multiple of 8."),
      integer_parameter("hidden_layers", 3, 1, 8, "ReLU layers."),
  };
  return table;
}

Dqn::Dqn(const Parameters& parameters)
    : parameters_(parameters),
      loss_kind_(parameters.text("loss") == "mse" ? learn::Loss::mse : learn::Loss::cross_entropy),
      use_target_network_(parameters.flag("target_network")),
      lifelong_(parameters.text("memory") == "lifelong"),
      minibatch_(count_of(parameters, "minibatch")),
      epochs_(count_of(parameters, "epochs")),
      target_copy_steps_(count_of(parameters, "target_copy_steps")),
      discount_(parameters.number("discount")),
      encoder_(encoder_settings(parameters)),
      replay_(count_of(parameters, "replay_capacity")) {
  if (replay_.capacity() < minibatch_)
    throw InputError("agent dqn: replay_capacity {} is smaller than minibatch {}; it would never train",
                     replay_.capacity(), minibatch_);
  if (parameters.integer("hidden_width") % 8 != 0)
    throw InputError("agent dqn: hidden_width {} is not allowed; use a multiple of 8 from 8 to 1024",
                     parameters.integer("hidden_width"));
  if (lifelong_ && memory_bytes(parameters) > limits::memory_bytes)
    throw InputError(
        "agent dqn: memory 'lifelong' would carry {} bytes from flight to flight, at most {} are possible; "
        "make hidden_width, hidden_layers or replay_capacity smaller",
        memory_bytes(parameters), limits::memory_bytes);
}

void Dqn::begin(const FlightInfo& flight) {
  const bool goes_on = lifelong_ && online_ != nullptr;
  flight_ = flight;
  encoder_.begin(flight);
  policy_random_ = RandomStream(flight.seed, flight.trial, policy_stream);
  replay_random_ = RandomStream(flight.seed, flight.trial, replay_stream);
  state_.clear();
  loss_ = 0.0;
  if (!goes_on) {
    start_learning(flight);
  } else if (online_->shape().inputs() != encoder_.inputs()) {
    throw InputError(
        "agent dqn: with memory 'lifelong' the network of earlier flights has {} inputs, this flight gives {}; do not "
        "mix generated and measured flights in one lineage",
        online_->shape().inputs(), encoder_.inputs());
  }
}

void Dqn::start_learning(const FlightInfo& flight) {
  encoder_.forget();
  replay_.clear();
  epsilon_ = parameters_.number("epsilon_start");
  trainings_ = 0;
  build_networks();
  RandomStream init_random(flight.seed, flight.trial, "dqn init");
  const learn::NetworkState initial = learn::initial_state(online_->shape(), init_random);
  online_->load(initial);
  if (target_) target_->load(initial);
}

void Dqn::build_networks() {
  const learn::NetworkShape shape = network_shape(parameters_, encoder_.inputs());
  if (online_ && online_->shape() == shape) return;
  const learn::AdamSettings adam{.learning_rate = parameters_.number("learning_rate")};
  online_ = learn::make_network(shape, adam);
  if (use_target_network_) target_ = learn::make_network(shape, adam);
}

void Dqn::observe(const Observation& observation) {
  const bool flown =
      observation.step > 0 && !encoder_.empty();  // the first report is no step of its own, even in mid-flight
  encoder_.observe(observation);
  if (flown) {
    remember(observation);
    if (replay_.size() >= minibatch_) train();
    epsilon_ = std::max(parameters_.number("epsilon_floor"), epsilon_ * parameters_.number("epsilon_decay"));
  }
  if (encoder_.complete()) state_ = encoder_.state();
}

void Dqn::remember(const Observation& observation) {
  if (state_.empty() || observation.executed == Action::absolute || observation.executed == Action::none) return;
  const auto action = static_cast<std::uint32_t>(observation.executed) - static_cast<std::uint32_t>(Action::down);
  replay_.add({state_, action, encoder_.reward(), encoder_.state(), observation.last});
}

void Dqn::set_target(learn::Minibatch& batch, std::size_t sample, const learn::Transition& transition, const QValues& q,
                     const QValues& next_q) const {
  const auto best_next = static_cast<double>(next_q[argmax(next_q)]);
  const auto updated =
      static_cast<float>(static_cast<double>(transition.reward) + (transition.terminal ? 0.0 : discount_ * best_next));
  const std::size_t row = sample * actions;
  if (loss_kind_ == learn::Loss::mse) {
    batch.targets[row + transition.action] = updated;
    batch.counted[row + transition.action] = 1.0F;
  } else {
    QValues with_update = q;
    with_update.at(transition.action) = updated;
    batch.targets[row + argmax(with_update)] = 1.0F;
  }
}

void Dqn::train() {
  const std::vector<const learn::Transition*> sampled = replay_.sample(minibatch_, replay_random_);
  learn::Minibatch batch{
      minibatch_, {}, std::vector<float>(minibatch_ * actions, 0.0F), std::vector<float>(minibatch_ * actions, 0.0F)};
  std::vector<float> next_states;
  for (const learn::Transition* transition : sampled) {
    batch.inputs.insert(batch.inputs.end(), transition->state.begin(), transition->state.end());
    next_states.insert(next_states.end(), transition->next_state.begin(), transition->next_state.end());
  }
  std::vector<float> q(minibatch_ * actions);
  std::vector<float> next_q(minibatch_ * actions);
  online_->predict(batch.inputs, q);
  (target_ ? target_ : online_)->predict(next_states, next_q);
  for (std::size_t s = 0; s < minibatch_; ++s) {
    const auto row = [&](const std::vector<float>& values) {
      return QValues{values[s * actions], values[s * actions + 1], values[s * actions + 2]};
    };
    set_target(batch, s, *sampled[s], row(q), row(next_q));
  }
  loss_ = online_->train(batch, loss_kind_, epochs_);
  ++trainings_;
  if (target_ && trainings_ % target_copy_steps_ == 0) target_->load({online_->state().weights, {}, {}, 0});
}

Command Dqn::act() {
  Introspection thoughts{.epsilon = epsilon_, .loss = loss_, .q_values = {}};
  const bool explore = policy_random_.uniform() < epsilon_;
  std::size_t action = policy_random_.uniform_index(actions);
  if (state_.empty()) {
    thoughts.epsilon = 1.0;
  } else {
    QValues q{};
    online_->predict(state_, q);
    std::ranges::copy(q, thoughts.q_values.begin());
    if (!explore) action = argmax(q);
  }
  return {static_cast<Action>(action + static_cast<std::size_t>(Action::down)), 0.0, thoughts};
}

namespace {

[[maybe_unused]] const bool dqn_registered = register_agent({
    .name = "dqn",
    .description = "The paper's deep Q-network, learning while it flies.",
    .learns = true,
    .looks = {{"dqn", 100, "#d04500", "#ff770d", {1, 0}}},
    .parameters = {dqn_parameters().begin(), dqn_parameters().end()},
    .make = [](const Parameters& parameters) { return std::make_unique<Dqn>(parameters); },
    .lineages =
        [](const Parameters& parameters) {
          return parameters.text("memory") == "lifelong" ? static_cast<std::uint32_t>(parameters.integer("lineages"))
                                                         : 0U;
        },
});

}  // namespace

}  // namespace aloft::agents
