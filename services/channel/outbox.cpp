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
  std::string digest = sha256_hex(wire::view(record.trace()));
  entries_.insert_or_assign(episode, Entry{std::move(record), std::move(digest), now});
}

std::optional<std::uint64_t> Outbox::settle(std::uint64_t episode_id, std::string_view trace_sha256,
                                            Clock::time_point now) {
  const auto at = entries_.find(episode_id);
  if (at == entries_.end() || at->second.trace_sha256 != trace_sha256) return std::nullopt;
  const std::uint64_t lease = at->second.record.lease_id();
  entries_.erase(at);
  progress_ = now;
  return lease;
}

void Outbox::send_due(Clock::time_point now, const Send& send) {
  for (auto& [episode, entry] : entries_) {
    if (entry.due > now) continue;
    send(entry.record);
    entry.due = now + resend_period;
  }
}

void Outbox::start_over() noexcept {
  for (auto& [episode, entry] : entries_) entry.due = Clock::time_point();
}

Clock::duration Outbox::silence(Clock::time_point now) const noexcept {
  return entries_.empty() ? Clock::duration::zero() : now - progress_;
}

}  // namespace aloft::channel
