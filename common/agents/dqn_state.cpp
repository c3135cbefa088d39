// Checkpoints of the DQN: everything that its future commands depend on.

#include <fmt/format.h>

#include "common/agents/dqn.hpp"
#include "common/agents/steering.hpp"

namespace aloft::agents {
namespace {

void save_network(StateWriter& writer, const std::string& name, const learn::Network& network) {
  const learn::NetworkState state = network.state();
  writer.put(name + ".weights", state.weights);
  writer.put(name + ".first_moments", state.first_moments);
  writer.put(name + ".second_moments", state.second_moments);
  writer.put_integer(name + ".steps", state.steps);
}

void restore_network(const StateReader& reader, const std::string& name, learn::Network& network) {
  const std::size_t n = network.shape().parameters();
  learn::NetworkState state{std::vector<float>(n), std::vector<float>(n), std::vector<float>(n),
                            reader.integer(name + ".steps")};
  reader.get(name + ".weights", state.weights);
  reader.get(name + ".first_moments", state.first_moments);
  reader.get(name + ".second_moments", state.second_moments);
  network.load(state);
}

}  // namespace

std::string Dqn::save_state() const {
  StateWriter writer(type_name, parameters_);
  writer.put_integer("begun", online_ ? 1 : 0);
  if (online_) {
    save_flight(writer, flight_);
    encoder_.save(writer);
    save_network(writer, "online", *online_);
    if (target_) save_network(writer, "target", *target_);
    save_replay(writer);
    writer.put_integer("policy_random", policy_random_.position());
    writer.put_integer("replay_random", replay_random_.position());
    writer.put_number("epsilon", epsilon_);
    writer.put_number("loss", loss_);
    writer.put_integer("trainings", trainings_);
    writer.put("state", state_);
  }
  return writer.bytes();
}

void Dqn::save_replay(StateWriter& writer) const {
  std::vector<float> states;
  std::vector<float> rewards;
  std::vector<std::int64_t> actions_and_ends;
  for (const learn::Transition& transition : replay_.slots()) {
    states.insert(states.end(), transition.state.begin(), transition.state.end());
    states.insert(states.end(), transition.next_state.begin(), transition.next_state.end());
    rewards.push_back(transition.reward);
    actions_and_ends.push_back(transition.action);
    actions_and_ends.push_back(transition.terminal ? 1 : 0);
  }
  writer.put("replay.states", states);
  writer.put("replay.rewards", rewards);
  writer.put("replay.actions_and_ends", actions_and_ends);
  writer.put_integer("replay.next_slot", replay_.next_slot());
}

void Dqn::restore_replay(const StateReader& reader) {
  const std::size_t width = encoder_.inputs();
  const auto rewards = reader.floats("replay.rewards");
  const std::size_t n = rewards.size();
  const std::size_t next_slot = reader.integer("replay.next_slot");
  if (n > replay_.capacity() || next_slot >= replay_.capacity()) reader.refuse("its replay memory is too large");
  std::vector<float> states(2 * n * width);
  reader.get("replay.states", states);
  std::vector<std::int64_t> actions_and_ends(2 * n);
  reader.get("replay.actions_and_ends", actions_and_ends);
  std::vector<learn::Transition> slots;
  const float* next = states.data();
  const auto take = [&] {
    next += width;
    return std::vector<float>(next - width, next);
  };
  for (std::size_t i = 0; i < n; ++i) {
    const std::int64_t action = actions_and_ends[2 * i];
    if (action < 0 || action >= static_cast<std::int64_t>(actions))
      reader.refuse(fmt::format("its replay memory has action {}", action));
    std::vector<float> state = take();
    slots.push_back(
        {std::move(state), static_cast<std::uint32_t>(action), rewards[i], take(), actions_and_ends[2 * i + 1] != 0});
  }
  replay_.restore(std::move(slots), next_slot);
}

void Dqn::restore_state(std::string_view bytes) {
  const StateReader reader(bytes, type_name, parameters_);
  Dqn restored(parameters_);  // so that a refused state leaves this agent as it was
  if (reader.integer("begun") != 0) restored.restore_flight_state(reader);
  *this = std::move(restored);
}

void Dqn::restore_flight_state(const StateReader& reader) {
  flight_ = restore_flight(reader);
  encoder_.begin(flight_);
  encoder_.restore(reader);
  build_networks();
  restore_network(reader, "online", *online_);
  if (target_) restore_network(reader, "target", *target_);
  restore_replay(reader);
  policy_random_ = RandomStream(flight_.seed, flight_.trial, policy_stream);
  policy_random_.seek(reader.integer("policy_random"));
  replay_random_ = RandomStream(flight_.seed, flight_.trial, replay_stream);
  replay_random_.seek(reader.integer("replay_random"));
  epsilon_ = reader.number("epsilon");
  loss_ = reader.number("loss");
  trainings_ = reader.integer("trainings");
  const auto state = reader.floats("state");
  if (!state.empty() && state.size() != encoder_.inputs()) reader.refuse("its latest state has another width");
  state_.assign(state.begin(), state.end());
}

}  // namespace aloft::agents
