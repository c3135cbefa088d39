#pragma once

#include <cstdint>
#include <vector>

namespace aloft::coordinator {

/// Doubly linked list over the indices of an array: O(1) everywhere, no allocation. Several lists may share one vector
/// of links as long as an index is in at most one of them.
class IndexList {
 public:
  static constexpr std::uint32_t none = 0xFFFFFFFF;

  struct Links {
    std::uint32_t previous = none;
    std::uint32_t next = none;
  };

  [[nodiscard]] std::uint32_t front() const noexcept { return head_; }
  [[nodiscard]] bool empty() const noexcept { return head_ == none; }

  void push_back(std::vector<Links>& links, std::uint32_t index) noexcept {
    links[index] = {tail_, none};
    (tail_ == none ? head_ : links[tail_].next) = index;
    tail_ = index;
  }

  void remove(std::vector<Links>& links, std::uint32_t index) noexcept {
    const Links gone = links[index];
    (gone.previous == none ? head_ : links[gone.previous].next) = gone.next;
    (gone.next == none ? tail_ : links[gone.next].previous) = gone.previous;
    links[index] = {};
  }

 private:
  std::uint32_t head_ = none;
  std::uint32_t tail_ = none;
};

}  // namespace aloft::coordinator
