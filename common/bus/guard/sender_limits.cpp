#include "common/bus/guard/sender_limits.hpp"

#include <algorithm>
#include <string_view>

namespace aloft::bus::guard {
namespace {

using namespace std::chrono_literals;

constexpr auto gaps_window = 10s;
constexpr auto pending_patience = 1s;  // fragments that got lost are sent again within milliseconds
constexpr auto sweep_period = 100ms;   // a flood must not make us search all the time
constexpr std::size_t max_addresses = 1024;
constexpr std::uint32_t all_other_addresses = 0;

}  // namespace

std::size_t SenderLimits::Hash::operator()(const Prefix& prefix) const noexcept {
  return std::hash<std::string_view>{}({reinterpret_cast<const char*>(prefix.data()), prefix.size()});
}

Refusal SenderLimits::admit(std::uint32_t address, const Claims& claims, Clock::time_point now) {
  for (const Claims::Announcement& announcement : claims.announcements)
    if (const Refusal refusal = announce(address, announcement, now); refusal != Refusal::none) return refusal;
  const auto sender = participants_.find(claims.sender);
  if (sender == participants_.end()) return spend(address, now) ? Refusal::none : Refusal::rate;
  sender->second.heard = now;
  return claim(sender->second, claims, now);
}

Refusal SenderLimits::announce(std::uint32_t address, const Claims::Announcement& announcement, Clock::time_point now) {
  auto known = participants_.find(announcement.participant);
  if (announcement.leaving) {
    if (!relayed_ || known == participants_.end()) return Refusal::none;
    --announced_[known->second.address];
    participants_.erase(known);
    return Refusal::none;
  }
  if (known == participants_.end()) {
    const auto full = [&] {
      const auto announced = announced_.find(address);
      return participants_.size() >= max_participants ||
             (!relayed_ && announced != announced_.end() && announced->second >= participants_per_address);
    };
    if (full()) forget_silent(now);
    if (full()) return Refusal::participants;
    ++announced_[address];
    known = participants_.try_emplace(announcement.participant).first;
    known->second.address = address;
  }
  known->second.lease = std::chrono::seconds(announcement.lease_s);
  known->second.heard = now;
  return Refusal::none;
}

void SenderLimits::forget_silent(Clock::time_point now) {
  if (now - swept_ < sweep_period) return;
  swept_ = now;
  std::erase_if(participants_, [&](const auto& entry) {
    const bool silent = now - entry.second.heard > entry.second.lease;
    if (silent) --announced_[entry.second.address];
    return silent;
  });
  std::erase_if(announced_, [](const auto& entry) { return entry.second == 0; });
}

/// A bucket for each address that refills with time.
bool SenderLimits::spend(std::uint32_t address, Clock::time_point now) {
  if (allowances_.size() >= max_addresses && !allowances_.contains(address)) address = all_other_addresses;
  const auto [at, is_new] = allowances_.try_emplace(address);
  Allowance& allowance = at->second;
  if (is_new) allowance.at = now;
  const double seconds = std::chrono::duration<double>(now - allowance.at).count();
  allowance.left = std::min(unannounced_at_once, allowance.left + unannounced_per_s * seconds);
  allowance.at = now;
  if (allowance.left < 1.0) return false;
  allowance.left -= 1.0;
  return true;
}

Refusal SenderLimits::claim(Participant& sender, const Claims& claims, Clock::time_point now) {
  if (claims.missing > 0) {
    if (now - sender.gaps_since > gaps_window) {
      sender.gaps = 0;
      sender.gaps_since = now;
    }
    if (sender.gaps + claims.missing > widest_gap) return Refusal::gap;
    sender.gaps += claims.missing;
  }
  for (const Claims::Fragments& fragments : claims.fragments) {
    std::erase_if(sender.pending, [&](const Pending& pending) { return now - pending.since > pending_patience; });
    auto at = std::find_if(sender.pending.begin(), sender.pending.end(), [&](const Pending& pending) {
      return pending.writer == fragments.writer && pending.sequence_number == fragments.sequence_number;
    });
    if (at == sender.pending.end()) {
      std::size_t bytes = fragments.sample_bytes;
      for (const Pending& pending : sender.pending) bytes += pending.sample_bytes;
      if (bytes > max_pending_bytes || sender.pending.size() >= max_pending) return Refusal::pending;
      at = sender.pending.insert(at, {.writer = fragments.writer,
                                      .sequence_number = fragments.sequence_number,
                                      .sample_bytes = fragments.sample_bytes,
                                      .missing = fragments.total,
                                      .since = now});
    }
    at->since = now;
    at->missing -= std::min(at->missing, fragments.arrived);
    if (at->missing == 0) sender.pending.erase(at);
  }
  return Refusal::none;
}

}  // namespace aloft::bus::guard
