#include "common/learn/replay.hpp"

#include <numeric>
#include <stdexcept>
#include <utility>

namespace aloft::learn {

void ReplayMemory::add(Transition transition) {
  if (slots_.size() < capacity_) {
    slots_.push_back(std::move(transition));
  } else {
    slots_[next_] = std::move(transition);
  }
  next_ = (next_ + 1) % capacity_;
}

void ReplayMemory::clear() noexcept {
  slots_.clear();
  next_ = 0;
}

std::vector<const Transition*> ReplayMemory::sample(std::size_t count, RandomStream& random) const {
  if (count > slots_.size()) throw std::logic_error("replay memory: sample larger than what is stored");
  std::vector<std::size_t> order(slots_.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::vector<const Transition*> chosen;
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t j = i + random.uniform_index(static_cast<std::uint32_t>(order.size() - i));
    std::swap(order[i], order[j]);
    chosen.push_back(&slots_[order[i]]);
  }
  return chosen;
}

void ReplayMemory::restore(std::vector<Transition> slots, std::size_t next_slot) {
  if (slots.size() > capacity_ || next_slot >= capacity_) throw std::logic_error("replay memory: state does not fit");
  slots_ = std::move(slots);
  next_ = next_slot;
}

}  // namespace aloft::learn
