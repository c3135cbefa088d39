#include "common/bus/middleware/one_message_at_a_time.hpp"

#include <mutex>
#include <utility>

namespace aloft::bus {

Transport one_message_at_a_time(Transport below) {
  const auto mutex = std::make_shared<std::mutex>();
  return receiving_through(
      [mutex](const unsigned char*, std::uint32_t, const rtps::Locator_t&, const auto& deliver) {
        // No deadlock: the calling thread has just read from its socket and holds no other lock.
        const std::lock_guard lock(*mutex);
        deliver();
      },
      std::move(below));
}

}  // namespace aloft::bus
