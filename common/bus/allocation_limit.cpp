#include "common/bus/allocation_limit.hpp"

#include <cstdint>
#include <cstdlib>
#include <new>

namespace {

thread_local std::size_t limit_bytes = SIZE_MAX;

}  // namespace

// The generated code resizes vectors of structures to whatever length the sample claims, and offers no way to say no.
// AddressSanitizer pairs its own operators, some of which are not replaced here: no limit then.
#if !defined(__SANITIZE_ADDRESS__)
void* operator new(std::size_t bytes) {
  if (bytes > limit_bytes) throw std::bad_alloc();
  if (void* memory = std::malloc(bytes == 0 ? 1 : bytes)) return memory;
  throw std::bad_alloc();
}
void operator delete(void* memory) noexcept {
  std::free(memory);
}
void operator delete(void* memory, std::size_t /*bytes*/) noexcept {
  std::free(memory);
}
#endif

namespace aloft::bus {

AllocationLimit::AllocationLimit(std::size_t bytes) noexcept {
  limit_bytes = bytes;
}

AllocationLimit::~AllocationLimit() {
  limit_bytes = SIZE_MAX;
}

}  // namespace aloft::bus
