#pragma once

#include <array>
#include <memory>
#include <span>
#include <string_view>

#include "common/agents/agent.hpp"
#include "common/agents/dqn_encoder.hpp"
#include "common/base/parameters.hpp"
#include "common/base/random.hpp"
#include "common/learn/network.hpp"
#include "common/learn/replay.hpp"

namespace aloft::agents {

/// The paper's deep Q-network (README; after Mnih et al. 2015). Where its text, code and results differ,
/// dqn_parameters() has each variant. It learns while it flies: every step it fits the network to one minibatch of
/// remembered steps for `epochs` gradient steps.
class Dqn final : public Agent {
 public:
  /// Throws InputError if parameters contradict each other.
  explicit Dqn(const Parameters& parameters);

  /// memory = per-flight: forgets everything. lifelong: keeps network, optimiser, replay memory and epsilon.
  void begin(const FlightInfo& flight) override;
  void observe(const Observation& observation) override;
  Command act() override;
  [[nodiscard]] std::string save_state() const override;
  void restore_state(std::string_view bytes) override;

 private:
  static constexpr std::string_view type_name = "dqn";
  static constexpr std::string_view policy_stream = "dqn policy";
  static constexpr std::string_view replay_stream = "dqn replay";
  static constexpr std::size_t actions = 3;  // down, hold, up
  using QValues = std::array<float, actions>;

  void start_learning(const FlightInfo& flight);
  void build_networks();
  void remember(const Observation& observation);
  void train();
  void set_target(learn::Minibatch& batch, std::size_t sample, const learn::Transition& transition, const QValues& q,
                  const QValues& next_q) const;
  void save_replay(StateWriter& writer) const;
  void restore_flight_state(const StateReader& reader);
  void restore_replay(const StateReader& reader);

  Parameters parameters_;
  learn::Loss loss_kind_;
  bool use_target_network_;
  bool lifelong_;
  std::size_t minibatch_;
  std::size_t epochs_;
  std::size_t target_copy_steps_;
  double discount_;

  DqnEncoder encoder_;
  FlightInfo flight_;
  std::unique_ptr<learn::Network> online_;
  std::unique_ptr<learn::Network> target_;  // only with use_target_network_
  learn::ReplayMemory replay_;
  RandomStream policy_random_{0, 0, policy_stream};
  RandomStream replay_random_{0, 0, replay_stream};
  double epsilon_ = 1.0;
  double loss_ = 0.0;
  std::size_t trainings_ = 0;
  std::vector<float> state_;  // at the latest report; empty while the history is incomplete
};

/// The table of parameters, with the published values as defaults.
[[nodiscard]] std::span<const ParameterSpec> dqn_parameters();

}  // namespace aloft::agents
