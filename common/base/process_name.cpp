#include "common/base/process_name.hpp"

#include <fmt/chrono.h>
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <ctime>
#include <random>

namespace aloft {
namespace {

ProcessName look_up() {
  std::random_device random;
  std::array<char, 65> host{};
  gethostname(host.data(), host.size() - 1);
  const std::uint64_t number = (std::uint64_t{random()} << 32U) | random();
  return {std::max<std::uint64_t>(number, 1), host.data(), static_cast<std::uint32_t>(getpid()),
          static_cast<std::uint64_t>(std::time(nullptr))};
}

}  // namespace

const ProcessName& this_process() {
  static const ProcessName self = look_up();
  return self;
}

std::string to_text(const ProcessName& process, std::string_view program) {
  const auto since = static_cast<std::time_t>(std::min(process.since_s, latest_since_s));
  return fmt::format("{} on host {} (process {}, since {:%Y-%m-%d %H:%M:%S})", program, process.host, process.pid,
                     fmt::localtime(since));
}

}  // namespace aloft
