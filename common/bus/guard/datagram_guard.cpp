#include "common/bus/guard/datagram_guard.hpp"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <utility>

namespace aloft::bus::guard {
namespace {

constexpr std::size_t max_told = 256;  // addresses that are named in the log

std::string dotted(std::uint32_t address) {
  return fmt::format("{}.{}.{}.{}", address >> 24U, address >> 16U & 0xffU, address >> 8U & 0xffU, address & 0xffU);
}

}  // namespace

bool DatagramGuard::admit(std::span<const unsigned char> datagram, std::uint32_t address) {
  Claims claims;
  Refusal reason = check_datagram(datagram, claims);
  if (reason == Refusal::none) {
    const auto now = SenderLimits::Clock::now();
    const std::lock_guard lock(mutex_);
    reason = limits_.admit(address, claims, now);
  }
  if (reason != Refusal::none) {
    refuse(reason, address);
    return false;
  }
  if (limits_.relayed()) return true;
  bool is_farewell = false;
  for (const Claims::Announcement& announcement : claims.announcements) {
    if (!announcement.leaving) continue;
    left_(announcement.participant);
    is_farewell = true;
  }
  return !is_farewell;
}

void DatagramGuard::refuse(Refusal reason, std::uint32_t address) {
  ++refused_.at(static_cast<std::size_t>(reason));
  {
    const std::lock_guard lock(mutex_);
    if (told_.size() >= max_told || !told_.insert(address).second) return;
  }
  spdlog::warn("refused a datagram from {} ({}); further ones from there are only counted", dotted(address),
               name(reason));
}

RefusalCounts DatagramGuard::refused() const noexcept {
  RefusalCounts counts{};
  for (std::size_t i = 0; i < counts.size(); ++i) counts[i] = refused_[i];
  return counts;
}

Transport guarded(std::shared_ptr<DatagramGuard> guard, Transport below) {
  return receiving_through(
      [guard = std::move(guard)](const unsigned char* bytes, std::uint32_t size, const auto& remote,
                                 const auto& deliver) {
        // An IPv4 address is the end of a locator's.
        const auto* end = remote.address + sizeof remote.address;
        const std::uint32_t address = WireBytes({end - 4, 4}, false).u32();
        if (guard->admit({bytes, size}, address)) deliver();
      },
      std::move(below));
}

}  // namespace aloft::bus::guard
