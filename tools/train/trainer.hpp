#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "common/base/parameters.hpp"
#include "common/learn/network.hpp"
#include "tools/train/rollout.hpp"

namespace aloft::train {

/// Called with each line of the validation log.
using Log = std::function<void(const std::string&)>;

/// How a network flies held-out worlds: mean quality per step of it, of staying at Zmin and of the best feasible
/// flight.
struct Validation {
  double network = 0.0;
  double min_height = 0.0;
  double best = 0.0;
};

/// Trains the network for one kind of quality by rollout policy iteration. The result is a function of `settings`
/// alone, whatever the number of threads.
///
/// Round 0 imitates the fully informed best flight on states of random flights. Each later round flies the present
/// network, with detours, through all worlds; from the states visited it tries each action and follows the network for
/// some steps; and fits the sums of quality. The round that is best on held-out worlds is kept.
class Trainer {
 public:
  Trainer(agents::QosKind kind, const Parameters& settings, unsigned threads, Log log);

  /// Weights in learn::NetworkState's layout.
  [[nodiscard]] std::vector<float> train();

 private:
  /// Fills samples, `worlds_per_item` fields at a time.
  using Collect = std::function<void(GreedyPolicy&, std::size_t first, std::size_t last, Samples&)>;
  [[nodiscard]] Samples collect(const Collect& from);
  void imitate(std::size_t first, std::size_t last, Samples& to) const;
  void visit(std::uint32_t round, GreedyPolicy& policy, std::size_t first, std::size_t last, Samples& to) const;
  void fit(std::uint32_t round);
  [[nodiscard]] double validate(std::uint32_t round);
  [[nodiscard]] Validation fly_held_out(std::size_t world, GreedyPolicy& policy) const;

  agents::QosKind kind_;
  Parameters settings_;
  unsigned threads_;
  Log log_;
  learn::NetworkShape shape_;
  std::vector<std::unique_ptr<learn::Network>> networks_;  // one per thread, all with weights_
  std::vector<float> weights_;
  std::vector<Field> fields_;
  std::vector<Field> held_out_;
  std::vector<Samples> rounds_;  // the latest
};

}  // namespace aloft::train
