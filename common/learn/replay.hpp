#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "common/base/random.hpp"

namespace aloft::learn {

/// One step of a flight that an agent learns from.
struct Transition {
  std::vector<float> state;
  std::uint32_t action = 0;
  float reward = 0.0F;
  std::vector<float> next_state;
  bool terminal = false;
};

/// Experience replay (Lin 1992; Mnih et al. 2015): a ring buffer of the latest transitions.
class ReplayMemory {
 public:
  explicit ReplayMemory(std::size_t capacity) : capacity_(capacity) {}

  /// Forgets the oldest transition when full.
  void add(Transition transition);
  void clear() noexcept;
  /// `count` <= size() different transitions, uniformly (the first steps of a Fisher-Yates shuffle); valid until the
  /// next add.
  [[nodiscard]] std::vector<const Transition*> sample(std::size_t count, RandomStream& random) const;

  [[nodiscard]] std::size_t size() const noexcept { return slots_.size(); }
  [[nodiscard]] std::size_t capacity() const noexcept { return capacity_; }
  /// The transitions in the order of storage, on which sampling depends. The slot next_slot() is overwritten next.
  [[nodiscard]] std::span<const Transition> slots() const noexcept { return slots_; }
  [[nodiscard]] std::size_t next_slot() const noexcept { return next_; }
  /// Puts back what slots() and next_slot() gave.
  void restore(std::vector<Transition> slots, std::size_t next_slot);

 private:
  std::size_t capacity_;
  std::size_t next_ = 0;
  std::vector<Transition> slots_;
};

}  // namespace aloft::learn
