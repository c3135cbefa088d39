#include "common/bus/middleware/rediscovery.hpp"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <string_view>
#include <utility>

namespace aloft::bus {
namespace {

// The list of endpoints usually comes within 0.1 s.
constexpr std::chrono::milliseconds first_patience{500};
// Takes four minutes; a peer that has not answered then does not know this protocol, or has no endpoints any more.
constexpr unsigned max_times_asked = 8;
constexpr std::chrono::milliseconds period{200};  // between two questions or announcements
constexpr std::size_t max_peers = 4096;
constexpr std::size_t max_asked = 64;
// A question is this text, and for each process that is asked its 12 bytes and the number of the question.
constexpr std::string_view question_mark = "aloft-who-are-you:";
constexpr std::size_t number_bytes = 4;
constexpr std::size_t entry_bytes = Rediscovery::Process::size + number_bytes;

void append(Rediscovery::Question& question, const Rediscovery::Process& process, std::uint32_t number) {
  question.insert(question.end(), process.value, process.value + Rediscovery::Process::size);
  for (std::size_t i = 0; i < number_bytes; ++i) question.push_back(static_cast<std::uint8_t>(number >> (8 * i)));
}

}  // namespace

Rediscovery::Peer& Rediscovery::peer_of(const Process& process) {
  if (peers_.size() >= max_peers && !peers_.contains(process))
    std::erase_if(peers_, [](const auto& entry) { return entry.second.gone; });
  return peers_[process];
}

void Rediscovery::heard(const Process& process, const std::string& name, Clock::time_point now) {
  const std::lock_guard lock(mutex_);
  Peer& peer = peer_of(process);
  peer.name = name;
  peer.silent_since.reset();
  if (!std::exchange(peer.gone, false)) return;
  peer.times_asked = 0;
  peer.due = now + first_patience;
}

void Rediscovery::forget(Peer& peer) {
  peer.gone = true;
  peer.due.reset();
  peer.writers.clear();
  peer.readers.clear();
}

void Rediscovery::left(const Process& process) {
  const std::lock_guard lock(mutex_);
  const auto at = peers_.find(process);
  if (at == peers_.end()) return;
  forget(at->second);
  at->second.silent_since.reset();
}

void Rediscovery::fell_silent(const Process& process, Clock::time_point now) {
  const std::lock_guard lock(mutex_);
  Peer& peer = peer_of(process);
  if (peer.gone) return;  // it has left
  forget(peer);
  peer.silent_since = now;
}

void Rediscovery::found(const Endpoint& endpoint, Kind kind) {
  const std::lock_guard lock(mutex_);
  Peer& peer = peer_of(endpoint.guidPrefix);
  (kind == Kind::writer ? peer.writers : peer.readers).insert(endpoint);
  (kind == Kind::writer ? peer.had_writers : peer.had_readers) = true;
}

void Rediscovery::removed(const Endpoint& endpoint, Kind kind) {
  const std::lock_guard lock(mutex_);
  const auto at = peers_.find(endpoint.guidPrefix);
  if (at != peers_.end()) (kind == Kind::writer ? at->second.writers : at->second.readers).erase(endpoint);
}

bool Rediscovery::waits() const {
  const std::lock_guard lock(mutex_);
  return std::any_of(peers_.begin(), peers_.end(), [](const auto& entry) { return entry.second.due.has_value(); });
}

std::optional<Rediscovery::Question> Rediscovery::question(Clock::time_point now) {
  const std::lock_guard lock(mutex_);
  Question question(question_mark.begin(), question_mark.end());
  std::size_t asked = 0;
  bool is_new = false;
  for (auto& [process, peer] : peers_) {
    if (!peer.due || asked == max_asked) continue;
    if (now >= *peer.due) {
      if (peer.complete() || peer.times_asked == max_times_asked) {
        peer.due.reset();
        continue;
      }
      peer.due = now + first_patience * (1U << ++peer.times_asked);
      peer.number = ++last_number_;
      is_new = true;
      spdlog::info("{} is back, but its readers or writers are not known: asking for them", peer.name);
    }
    if (peer.times_asked == 0) continue;
    append(question, process, peer.number);
    ++asked;
  }
  return is_new ? std::optional(std::move(question)) : std::nullopt;
}

bool Rediscovery::asks(const Process& asker, const Question& question, const Process& self) {
  if (question.size() < question_mark.size() ||
      !std::equal(question_mark.begin(), question_mark.end(), question.begin()))
    return false;
  const std::lock_guard lock(mutex_);
  for (std::size_t at = question_mark.size(); at + entry_bytes <= question.size(); at += entry_bytes) {
    const auto entry = question.begin() + static_cast<std::ptrdiff_t>(at);
    if (!std::equal(self.value, self.value + Process::size, entry)) continue;
    std::uint32_t number = 0;
    for (std::size_t i = 0; i < number_bytes; ++i)
      number |= static_cast<std::uint32_t>(entry[static_cast<std::ptrdiff_t>(Process::size + i)]) << (8 * i);
    if (answered_.size() >= max_peers) answered_.clear();
    return std::exchange(answered_[asker], number) != number;
  }
  return false;
}

std::vector<std::string> Rediscovery::absent(Clock::duration patience, Clock::time_point now) const {
  const std::lock_guard lock(mutex_);
  std::set<std::string_view> present;
  for (const auto& [process, peer] : peers_)
    if (!peer.gone) present.insert(peer.name);
  std::vector<std::string> names;
  for (const auto& [process, peer] : peers_) {
    const bool silent = peer.silent_since && now - *peer.silent_since < patience && !present.contains(peer.name);
    if (silent || peer.due) names.push_back(peer.name);
  }
  return names;
}

RediscoveryThread::RediscoveryThread(Rediscovery& rediscovery, Ask ask, std::function<void()> announce)
    : rediscovery_(rediscovery), ask_(std::move(ask)), announce_(std::move(announce)) {
  thread_ = std::jthread([this](const std::stop_token& stop) { work(stop); });
}

void RediscoveryThread::peer_is_back() {
  const std::lock_guard lock(mutex_);
  peer_is_back_ = true;
  changed_.notify_one();
}

void RediscoveryThread::peer_asks() {
  const std::lock_guard lock(mutex_);
  peer_asks_ = true;
  changed_.notify_one();
}

void RediscoveryThread::end() {
  thread_.request_stop();
  thread_.join();
}

void RediscoveryThread::work(const std::stop_token& stop) {
  std::unique_lock lock(mutex_);
  // The wait is also true after a stop, when a peer is still to be asked.
  while (changed_.wait(lock, stop, [this] { return peer_asks_ || peer_is_back_; }) && !stop.stop_requested()) {
    const bool asked = std::exchange(peer_asks_, false);
    peer_is_back_ = false;
    lock.unlock();
    if (asked) {
      spdlog::info("a peer asked for our endpoints: announcing them again");
      announce_();
    }
    if (const auto question = rediscovery_.question(Rediscovery::Clock::now())) ask_(*question);
    const bool waits = rediscovery_.waits();
    lock.lock();
    peer_is_back_ = peer_is_back_ || waits;  // a peer may have come back meanwhile
    changed_.wait_for(lock, stop, period, [] { return false; });
  }
}

}  // namespace aloft::bus
