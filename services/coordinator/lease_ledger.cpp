#include "services/coordinator/lease_ledger.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <numeric>
#include <stdexcept>
#include <utility>

#include "common/base/permutation.hpp"

namespace aloft::coordinator {
namespace {

// How many lost or failed trials are looked at to find one that another worker held: a bound on the cost of a grant.
constexpr int retries_looked_at = 8;
// How many trials are looked at, at a time, for one with an agent that the worker flies.
constexpr int trials_looked_at = 256;

void check(bool in_range, std::string_view option, std::uint64_t value, std::string_view allowed) {
  if (!in_range)
    throw std::invalid_argument(fmt::format("LedgerOptions::{} is {}; allowed: {}", option, value, allowed));
}

std::size_t checked_size(const LedgerOptions& options) {
  const std::uint64_t size = std::uint64_t{options.conditions} * options.trials;
  check(size >= 1 && size < IndexList::none, "conditions * trials", size, "1 to 4294967294");
  check(options.agents >= 1 && options.agents <= 4096, "agents", options.agents, "1 to 4096");
  check(options.max_attempts >= 1 && options.max_attempts <= 255, "max_attempts", options.max_attempts, "1 to 255");
  check(options.max_losses >= 1 && options.max_losses <= 255, "max_losses", options.max_losses, "1 to 255");
  return size;
}

std::vector<std::uint32_t> lease_order(const LedgerOptions& options, std::size_t trials) {
  if (options.order == TrialOrder::shuffled) {
    RandomStream random(options.order_seed, 0, "trial-order");
    return permutation(static_cast<std::uint32_t>(trials), random);
  }
  std::vector<std::uint32_t> order(trials);
  std::iota(order.begin(), order.end(), 0U);
  return order;
}

}  // namespace

LeaseLedger::LeaseLedger(const LedgerOptions& options)
    : options_(options),
      slots_(checked_size(options)),
      links_(slots_.size()),
      stored_(slots_.size() * options.agents),
      grants_(options.first_grant) {
  counts_[static_cast<std::size_t>(TrialState::pending)] = slots_.size();
  for (const std::uint32_t trial : lease_order(options, slots_.size())) {
    slots_[trial].missing = static_cast<std::uint16_t>(options.agents);
    if (predecessor(trial) == none) enqueue(trial, Queue::fresh);
  }
}

bool LeaseLedger::flight_stored(std::uint32_t condition, std::uint32_t trial, std::uint32_t agent) {
  const std::uint32_t at = index(condition, trial);
  if (agent >= options_.agents) throw std::out_of_range("LeaseLedger: no such agent");
  const std::size_t flight = std::size_t{at} * options_.agents + agent;
  if (stored_[flight]) return false;
  stored_[flight] = true;
  ++flights_stored_;
  Slot& slot = slots_[at];
  if (--slot.missing > 0) {
    if (slot.state == TrialState::leased && !has_work_for(slot.worker, at)) {  // another worker flies the rest
      erase_lease(at);
      set_state(at, TrialState::pending);
      enqueue(at, Queue::retry);
    }
    return true;
  }

  if (slot.state == TrialState::leased) erase_lease(at);
  if (slot.state == TrialState::failed)
    std::erase_if(reasons_, [at](const auto& reason) { return reason.first == at; });
  dequeue(at);
  set_state(at, TrialState::done);
  if (const std::uint32_t next = successor(at); next != none && slots_[next].queue == Queue::nowhere) {
    Slot& follower = slots_[next];
    const bool failed_with_us = follower.state == TrialState::failed && follower.failures == 0 && follower.losses == 0;
    if (failed_with_us) {
      std::erase_if(reasons_, [&](const auto& reason) { return reason.first == next; });
      set_state(next, TrialState::pending);
    }
    if (follower.state == TrialState::pending) enqueue(next, Queue::fresh);
  }
  return true;
}

HeartbeatResult LeaseLedger::heartbeat(const WorkerReport& report, Clock::time_point now) {
  if (!report.flies.empty() && report.flies.size() != options_.agents)
    throw std::invalid_argument(
        fmt::format("WorkerReport::flies has {} entries; allowed: none or {}", report.flies.size(), options_.agents));
  HeartbeatResult result;
  const auto known = names_.find(report.name);
  if (report.capacity == 0) {
    if (known != names_.end()) leave(known->second, result);
    return result;
  }
  const std::uint32_t at = known != names_.end() ? known->second : add_worker(report);
  Worker& worker = workers_[at];
  seen_.remove(seen_links_, at);
  seen_.push_back(seen_links_, at);
  worker.seen = now;
  worker.capacity = std::min(report.capacity, max_capacity);
  worker.flies = report.flies;

  const bool restarted = worker.incarnation != report.incarnation;
  worker.incarnation = report.incarnation;
  result.joined = restarted || known == names_.end();
  for (const std::uint64_t lease : report.leases)
    if (!claim(at, lease, now, result)) result.cancel.push_back(lease);
  for (const LiveLease& lease : worker.leases)
    if (restarted ? lease.listed != now : now - lease.listed > options_.unclaimed_timeout)
      result.lost.push_back(lease.id);
  for (const std::uint64_t lease : result.lost) lose(trial_index(lease));
  update_hungry(at);
  return result;
}

/// True if the worker holds this lease, or can adopt it: a lease id names its trial, so a coordinator that has just
/// started recognises flights in the air.
bool LeaseLedger::claim(std::uint32_t worker, std::uint64_t lease, Clock::time_point now, HeartbeatResult& result) {
  std::vector<LiveLease>& leases = workers_[worker].leases;
  const auto live = std::ranges::find(leases, lease, &LiveLease::id);
  if (live != leases.end()) {
    live->listed = now;
    return true;
  }
  const std::uint32_t trial = trial_index(lease);
  if (trial >= slots_.size() || slots_[trial].queue == Queue::nowhere || leases.size() >= max_capacity) return false;
  Slot& slot = slots_[trial];
  const bool gave_it_up = slot.failures > 0 && slot.worker == worker;
  if (gave_it_up || !has_work_for(worker, trial)) return false;
  dequeue(trial);
  slot.worker = worker;
  set_state(trial, TrialState::leased);
  leases.push_back({lease, now});
  result.adopted.push_back(lease);
  return true;
}

void LeaseLedger::lease_failed(std::uint64_t lease, std::string_view reason) {
  const std::uint32_t trial = trial_index(lease);
  if (trial >= slots_.size()) return;
  Slot& slot = slots_[trial];
  if (slot.state != TrialState::leased || !holds(slot.worker, lease)) return;
  erase_lease(trial);
  if (++slot.failures >= options_.max_attempts) return fail_for_good(trial, std::string(reason));
  set_state(trial, TrialState::pending);
  enqueue(trial, Queue::retry);
}

std::vector<LostWorker> LeaseLedger::expire(Clock::time_point now) {
  std::vector<LostWorker> lost;
  while (!seen_.empty() && now - workers_[seen_.front()].seen > options_.heartbeat_timeout) {
    const std::uint32_t at = seen_.front();
    Worker& worker = workers_[at];
    LostWorker gone{worker.name, now - worker.seen, {}};
    for (const LiveLease& lease : worker.leases) gone.leases.push_back(lease.id);
    for (const std::uint64_t lease : gone.leases) lose(trial_index(lease));
    remove_worker(at);
    lost.push_back(std::move(gone));
  }
  return lost;
}

bool LeaseLedger::grant(Clock::time_point now, Lease& lease) {
  if (retry_.empty() && fresh_.empty()) return false;
  std::uint32_t at = hungry_.front();
  std::uint32_t trial = none;
  while (at != none && (trial = seek_trial_for(at)) == none) at = hungry_links_[at].next;
  if (at == none) return false;
  Worker& worker = workers_[at];
  Slot& slot = slots_[trial];
  lease.id = (std::uint64_t{trial} << 32U) | grants_++;
  lease.worker = worker.name;
  lease.condition = trial / options_.trials;
  lease.trial = trial % options_.trials;
  lease.attempt = 1U + slot.failures + slot.losses;
  lease.agents = missing_agents(at, trial);

  dequeue(trial);
  set_state(trial, TrialState::leased);
  slot.worker = at;
  worker.leases.push_back({lease.id, now});
  hungry_.remove(hungry_links_, at);
  worker.hungry = false;
  update_hungry(at);
  return true;
}

std::uint32_t LeaseLedger::seek_trial_for(std::uint32_t worker) noexcept {
  const bool alone = names_.size() == 1;
  const std::uint32_t first_retry = rotate_to_first_for(worker, retry_);
  std::uint32_t retry = first_retry;
  for (int looked_at = 0; retry != none && looked_at < retries_looked_at; ++looked_at, retry = links_[retry].next)
    if ((alone || slots_[retry].worker != worker) && has_work_for(worker, retry)) return retry;
  const std::uint32_t fresh = rotate_to_first_for(worker, fresh_);
  return fresh == none ? first_retry : fresh;
}

/// The first trial in the queue with an agent that the worker flies. Trials before it go to the end of the queue, so
/// that repeated calls look at all of them, each call at a bounded number.
std::uint32_t LeaseLedger::rotate_to_first_for(std::uint32_t worker, IndexList& queue) noexcept {
  for (int looked_at = 0; !queue.empty() && looked_at < trials_looked_at; ++looked_at) {
    const std::uint32_t trial = queue.front();
    if (has_work_for(worker, trial)) return trial;
    queue.remove(links_, trial);
    queue.push_back(links_, trial);
  }
  return none;
}

bool LeaseLedger::has_work_for(std::uint32_t worker, std::uint32_t trial_index) const noexcept {
  const std::vector<bool>& flies = workers_[worker].flies;
  if (flies.empty()) return slots_[trial_index].missing > 0;
  for (std::uint32_t agent = 0; agent < options_.agents; ++agent)
    if (flies[agent] && !stored_[std::size_t{trial_index} * options_.agents + agent]) return true;
  return false;
}

std::vector<std::uint32_t> LeaseLedger::missing_agents(std::uint32_t worker, std::uint32_t trial_index) const {
  const std::vector<bool>& flies = workers_[worker].flies;
  std::vector<std::uint32_t> agents;
  for (std::uint32_t agent = 0; agent < options_.agents; ++agent)
    if ((flies.empty() || flies[agent]) && !stored_[std::size_t{trial_index} * options_.agents + agent])
      agents.push_back(agent);
  return agents;
}

bool LeaseLedger::finished() const noexcept {
  return count(TrialState::done) + count(TrialState::failed) == slots_.size();
}

TrialState LeaseLedger::state(std::uint32_t condition, std::uint32_t trial) const {
  return slots_[index(condition, trial)].state;
}

bool LeaseLedger::is_stored(std::uint32_t condition, std::uint32_t trial, std::uint32_t agent) const {
  return stored_.at(std::size_t{index(condition, trial)} * options_.agents + agent);
}

std::optional<std::pair<std::uint32_t, std::uint32_t>> LeaseLedger::trial_of(std::uint64_t lease) const noexcept {
  const std::uint32_t trial = trial_index(lease);
  if (trial >= slots_.size()) return std::nullopt;
  return std::pair{trial / options_.trials, trial % options_.trials};
}

std::vector<Failure> LeaseLedger::failures() const {
  std::vector<Failure> failures;
  failures.reserve(reasons_.size());
  for (const auto& [trial, reason] : reasons_)
    failures.push_back({trial / options_.trials, trial % options_.trials, reason});
  return failures;
}

std::size_t LeaseLedger::memory_bytes() const noexcept {
  std::size_t bytes = slots_.capacity() * sizeof(Slot) + links_.capacity() * sizeof(IndexList::Links) +
                      stored_.capacity() / 8 + workers_.capacity() * (sizeof(Worker) + 2 * sizeof(IndexList::Links));
  for (const Worker& worker : workers_) bytes += worker.leases.capacity() * sizeof(LiveLease);
  return bytes;
}

std::uint32_t LeaseLedger::index(std::uint32_t condition, std::uint32_t trial) const {
  if (condition >= options_.conditions || trial >= options_.trials)
    throw std::out_of_range(fmt::format("LeaseLedger: no trial {} of condition {}", trial, condition));
  return condition * options_.trials + trial;
}

std::uint32_t LeaseLedger::predecessor(std::uint32_t trial_index) const noexcept {
  const bool first = options_.lineages == 0 || trial_index % options_.trials < options_.lineages;
  return first ? none : trial_index - options_.lineages;
}

std::uint32_t LeaseLedger::successor(std::uint32_t trial_index) const noexcept {
  const bool last = options_.lineages == 0 || options_.trials - trial_index % options_.trials <= options_.lineages;
  return last ? none : trial_index + options_.lineages;
}

void LeaseLedger::set_state(std::uint32_t trial_index, TrialState state) noexcept {
  TrialState& current = slots_[trial_index].state;
  --counts_[static_cast<std::size_t>(current)];
  ++counts_[static_cast<std::size_t>(state)];
  current = state;
}

void LeaseLedger::enqueue(std::uint32_t trial_index, Queue queue) noexcept {
  (queue == Queue::fresh ? fresh_ : retry_).push_back(links_, trial_index);
  slots_[trial_index].queue = queue;
}

void LeaseLedger::dequeue(std::uint32_t trial_index) noexcept {
  Queue& queue = slots_[trial_index].queue;
  if (queue == Queue::nowhere) return;
  (queue == Queue::fresh ? fresh_ : retry_).remove(links_, trial_index);
  queue = Queue::nowhere;
}

std::uint32_t LeaseLedger::add_worker(const WorkerReport& report) {
  std::uint32_t at = 0;
  if (free_workers_.empty()) {
    at = static_cast<std::uint32_t>(workers_.size());
    workers_.emplace_back();
    seen_links_.emplace_back();
    hungry_links_.emplace_back();
  } else {
    at = free_workers_.back();
    free_workers_.pop_back();
  }
  workers_[at].name = report.name;
  workers_[at].incarnation = report.incarnation;
  names_.emplace(report.name, at);
  seen_.push_back(seen_links_, at);
  return at;
}

void LeaseLedger::remove_worker(std::uint32_t worker) {
  workers_[worker].capacity = 0;
  update_hungry(worker);
  seen_.remove(seen_links_, worker);
  names_.erase(workers_[worker].name);
  free_workers_.push_back(worker);
}

/// A worker that leaves in good order counts as no loss of its trials.
void LeaseLedger::leave(std::uint32_t worker, HeartbeatResult& result) {
  result.left = true;
  for (const LiveLease& lease : workers_[worker].leases) result.lost.push_back(lease.id);
  for (const std::uint64_t lease : result.lost) {
    erase_lease(trial_index(lease));
    set_state(trial_index(lease), TrialState::pending);
    enqueue(trial_index(lease), Queue::retry);
  }
  remove_worker(worker);
}

/// To be called after a change of capacity or leases: hungry_ holds exactly the workers with free capacity.
void LeaseLedger::update_hungry(std::uint32_t worker) {
  Worker& self = workers_[worker];
  const bool has_room = self.leases.size() < self.capacity;
  if (has_room == self.hungry) return;
  if (has_room)
    hungry_.push_back(hungry_links_, worker);
  else
    hungry_.remove(hungry_links_, worker);
  self.hungry = has_room;
}

bool LeaseLedger::holds(std::uint32_t worker, std::uint64_t lease) const noexcept {
  const std::vector<LiveLease>& leases = workers_[worker].leases;
  return std::ranges::any_of(leases, [lease](const LiveLease& own) { return own.id == lease; });
}

void LeaseLedger::erase_lease(std::uint32_t trial_index) noexcept {
  const std::uint32_t worker = slots_[trial_index].worker;
  std::erase_if(workers_[worker].leases,
                [trial_index](const LiveLease& lease) { return LeaseLedger::trial_index(lease.id) == trial_index; });
  update_hungry(worker);
}

void LeaseLedger::lose(std::uint32_t trial_index) {
  erase_lease(trial_index);
  Slot& slot = slots_[trial_index];
  if (++slot.losses >= options_.max_losses)
    return fail_for_good(trial_index, fmt::format("{} workers were lost while they flew it", options_.max_losses));
  set_state(trial_index, TrialState::lost);
  enqueue(trial_index, Queue::retry);
}

/// Also fails the trials that wait for this one.
void LeaseLedger::fail_for_good(std::uint32_t trial_index, std::string reason) {
  for (std::uint32_t trial = trial_index; trial != none;) {
    set_state(trial, TrialState::failed);
    if (reasons_.size() < reasons_kept) reasons_.emplace_back(trial, reason);
    reason = fmt::format("its predecessor, trial {}, failed", trial % options_.trials);
    trial = successor(trial);
    const bool waits =
        trial != none && slots_[trial].state == TrialState::pending && slots_[trial].queue == Queue::nowhere;
    if (!waits) return;
  }
}

}  // namespace aloft::coordinator
