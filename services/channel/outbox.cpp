#include "services/channel/outbox.hpp"

#include <utility>

#include "common/base/digest.hpp"

namespace aloft::channel {
namespace {

constexpr std::chrono::seconds resend_period{2};

}  // namespace

void Outbox::add(wire::EpisodeRecord record, Clock::time_point now) {
  if (entries_.empty()) progress_ = now;
  const std::uint64_t episode = record.episode_id();
  entries_.insert_or_assign(episode, Entry{std::move(record), now});
}

std::uint64_t Outbox::confirm(std::uint64_t episode_id) {
  const auto at = entries_.find(episode_id);
  if (at == entries_.end()) return 0;
  const std::uint64_t lease = at->second.record.lease_id();
  entries_.erase(at);
  progress_ = Clock::now();
  return lease;
}

std::optional<std::uint64_t> Outbox::give_up(std::uint64_t episode_id, std::string_view trace_sha256) {
  const auto at = entries_.find(episode_id);
  if (at == entries_.end() || sha256_hex(wire::view(at->second.record.trace())) != trace_sha256) return std::nullopt;
  return confirm(episode_id);
}

void Outbox::send_due(Clock::time_point now, const Send& send) {
  for (auto& [episode, entry] : entries_) {
    if (entry.due > now) continue;
    send(entry.record);
    entry.due = now + resend_period;
  }
}

Clock::duration Outbox::silence(Clock::time_point now) const noexcept {
  return entries_.empty() ? Clock::duration::zero() : now - progress_;
}

}  // namespace aloft::channel
