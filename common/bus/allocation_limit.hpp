#pragma once

#include <cstddef>

namespace aloft::bus {

/// While it lives, this thread cannot allocate more than `bytes` at once: std::bad_alloc. A malformed sample that
/// claims to hold a sequence of four thousand million elements must not get the memory for them.
class AllocationLimit {
 public:
  explicit AllocationLimit(std::size_t bytes) noexcept;
  ~AllocationLimit();
  AllocationLimit(const AllocationLimit&) = delete;
  AllocationLimit& operator=(const AllocationLimit&) = delete;
};

}  // namespace aloft::bus
