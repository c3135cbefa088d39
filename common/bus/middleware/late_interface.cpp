#include "common/bus/middleware/late_interface.hpp"

#include <fmt/format.h>

#include <chrono>
#include <stdexcept>
#include <thread>

#include "common/bus/network.hpp"

namespace aloft::bus {

void wait_until_running(const std::string& address) {
  constexpr std::chrono::seconds limit{10};
  const auto deadline = std::chrono::steady_clock::now() + limit;
  while (!is_running(address)) {
    if (std::chrono::steady_clock::now() > deadline)
      throw std::runtime_error(fmt::format(
          "the network interface with the address {} has been down for {} s; see: ip address", address, limit.count()));
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
  }
}

}  // namespace aloft::bus
