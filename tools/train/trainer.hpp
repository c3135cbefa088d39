#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "common/agents/observation.hpp"
#include "common/base/parameters.hpp"
#include "common/learn/network.hpp"
#include "tools/train/parallel.hpp"
#include "tools/train/rollout.hpp"

namespace aloft::train {

/// Mean quality per step on held-out worlds: of the network, of staying at Zmin and of the best feasible flight.
struct Validation {
  double network = 0.0;
  double min_height = 0.0;
  double best = 0.0;
};

/// Trains the network for one kind of quality by rollout policy iteration. The result is a function of `settings`
/// alone, whatever the number of threads and however often it was interrupted and restored.
///
/// Round 0 imitates the fully informed best flight on states of random flights. Each later round flies the present
/// network, with detours, through all worlds; from the states visited it tries each action and follows the network for
/// some steps; and fits the sums of quality. The round that is best on held-out worlds is kept.
class Trainer {
 public:
  Trainer(radio::QosKind kind, const Parameters& settings, unsigned threads, Watch watch);

  [[nodiscard]] bool finished() const noexcept;
  /// Trains the next round. After Interrupted, only a state saved before can be used.
  void train_round();
  /// Weights of the best round so far, in the layout of learn::NetworkState.
  [[nodiscard]] const std::vector<float>& best_weights() const noexcept { return best_; }
  /// One line per finished round: gains over min-height and of the best feasible flight.
  [[nodiscard]] std::vector<std::string> validation_log() const;

  /// The state from which training continues after the last finished round.
  [[nodiscard]] std::string save_state() const;
  /// IntegrityError if the bytes are not a state of a trainer with these settings.
  void restore_state(std::string_view bytes);

 private:
  /// Samples of one round and the weights that they were collected with.
  struct Round {
    std::uint32_t number = 0;
    std::vector<float> weights;
    Samples samples;
  };
  [[nodiscard]] std::string phase(std::uint32_t round, const char* what) const;
  [[nodiscard]] Samples samples_of(std::uint32_t round);
  /// Fills samples, `worlds_per_item` fields at a time.
  using Collect = std::function<void(GreedyPolicy&, std::size_t first, std::size_t last, Samples&)>;
  [[nodiscard]] Samples collect(std::uint32_t round, const Collect& from);
  void imitate(std::size_t first, std::size_t last, Samples& to) const;
  void visit(std::uint32_t round, GreedyPolicy& policy, std::size_t first, std::size_t last, Samples& to) const;
  void fit(std::uint32_t round);
  [[nodiscard]] std::vector<Validation> validate(std::uint32_t round);
  [[nodiscard]] Validation fly_held_out(std::size_t world, GreedyPolicy& policy) const;

  radio::QosKind kind_;
  Parameters settings_;
  unsigned threads_;
  Watch watch_;
  learn::NetworkShape shape_;
  std::vector<std::unique_ptr<learn::Network>> networks_;  // one per thread, all with weights_
  std::uint32_t next_round_ = 0;
  std::vector<float> weights_;
  std::vector<float> best_;
  std::vector<std::vector<Validation>> validations_;  // per round and group of worlds
  std::vector<Field> fields_;
  std::vector<Field> held_out_;
  std::vector<Round> rounds_;  // the latest
};

}  // namespace aloft::train
