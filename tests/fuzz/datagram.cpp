// Datagrams from one address, as the guard before the middleware sees them: each after its size in two bytes.
#include <algorithm>
#include <memory>

#include "common/bus/guard/sender_limits.hpp"
#include "tests/fuzz/target.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace aloft::bus;
  guard::SenderLimits limits(false);
  guard::SenderLimits::Clock::time_point now{};
  while (size >= 2) {
    const std::size_t wanted = data[0] + std::size_t{256} * data[1];
    const std::size_t length = std::min(wanted, size - 2);
    // A copy, so that the sanitizers see a read beyond the end.
    const auto copy = std::make_unique<unsigned char[]>(length);
    std::copy_n(data + 2, length, copy.get());
    data += 2 + length;
    size -= 2 + length;
    guard::Claims claims;
    if (guard::check_datagram({copy.get(), length}, claims) != Refusal::none) continue;
    now += std::chrono::milliseconds(10);
    static_cast<void>(limits.admit(0x7F000001, claims, now));
  }
  return 0;
}
