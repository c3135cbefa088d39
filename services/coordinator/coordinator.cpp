#include "services/coordinator/coordinator.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <cmath>

#include "common/base/seconds.hpp"

namespace aloft::coordinator {
namespace {

constexpr std::size_t names_listed = 4;                // in messages
constexpr double rate_memory_s = 5.0;                  // of the moving averages
constexpr auto pause_shown = std::chrono::seconds(3);  // after the collector last reported it
constexpr auto trouble_shown = std::chrono::seconds(20);

LedgerOptions ledger_options(const experiment::Experiment& experiment, const CoordinatorOptions& options,
                             std::uint32_t first_grant) {
  LedgerOptions ledger;
  ledger.conditions = static_cast<std::uint32_t>(experiment.conditions.size());
  ledger.trials = experiment.trials;
  ledger.agents = static_cast<std::uint32_t>(experiment.agents.size());
  ledger.max_attempts = std::clamp(experiment.max_attempts, 1U, 255U);
  ledger.lineages = experiment::trial_lineages(experiment);
  ledger.heartbeat_timeout = options.heartbeat_timeout;
  ledger.unclaimed_timeout = options.unclaimed_timeout;
  ledger.order = options.order;
  ledger.order_seed = first_grant;  // any seed: results must not depend on the order
  ledger.first_grant = first_grant;
  return ledger;
}

}  // namespace

Coordinator::Coordinator(const experiment::Experiment& experiment, const CoordinatorOptions& options,
                         std::uint32_t first_grant, Clock::time_point now)
    : experiment_(experiment),
      options_(options),
      ledger_(ledger_options(experiment, options, first_grant)),
      grant_from_(now),
      worker_seen_(now),
      stored_at_(now),
      flights_missing_(experiment.agents.size(), std::uint64_t{experiment.conditions.size()} * experiment.trials),
      rates_at_(now) {
  for (const auto& agent : experiment.agents)
    agent_index_.emplace(agent.name, static_cast<std::uint32_t>(agent_index_.size()));
}

bool Coordinator::resume(const experiment::FlightKey& flight) {
  if (!knows(flight)) return false;
  // worker_seen_ is still the moment of the start.
  grant_from_ = worker_seen_ + options_.adoption_time;
  store(flight);
  return true;
}

void Coordinator::on_worker(const WorkerNews& news, Clock::time_point now) {
  const std::string name(news.report.name);
  using enum Namesakes::Verdict;
  const Namesakes::Verdict verdict =
      namesakes_.hear(name, {news.report.incarnation, news.host, news.pid, now}, news.report.capacity == 0);
  if (verdict == doubled) spdlog::warn("{}", namesakes_.text(now));  // the status repeats it as long as it lasts
  if (verdict == doubled || verdict == held_back) return hold_back(news);
  if (verdict == other_left) return;
  take_failures(news, now);
  WorkerReport report = news.report;
  report.flies = flies(news);
  const HeartbeatResult result = ledger_.heartbeat(report, now);
  if (report.capacity == 0) {
    forget(name);
    if (result.left)
      spdlog::info("worker {} has left{}{}", name,
                   result.lost.empty() ? "" : "; to be flown by others: ", trial_names(result.lost));
    return;
  }
  count_steps(news);
  workers_.find(name)->second.flies = std::move(report.flies);
  worker_seen_ = now;
  if (records_unconfirmed_ == 0) stored_at_ = now;
  if (result.joined)
    spdlog::info("worker {} is here (process {}); {} workers", name, news.report.incarnation, workers_.size());
  if (!result.adopted.empty()) spdlog::info("worker {} is flying {}", name, trial_names(result.adopted));
  if (!result.lost.empty())
    trouble(fmt::format("worker {} no longer flies {}; to be flown again", name, trial_names(result.lost)), now);
  for (const std::uint64_t lease : result.cancel) cancel(name, lease);
}

/// Its trials go to others, as if it had left, and without counting a loss.
void Coordinator::hold_back(const WorkerNews& news) {
  WorkerReport farewell = news.report;
  farewell.capacity = 0;
  (void)ledger_.heartbeat(farewell, {});
  forget(news.report.name);
  for (const std::uint64_t lease : news.report.leases) cancel(news.report.name, lease);
}

void Coordinator::cancel(std::string_view worker, std::uint64_t lease) {
  Order order;
  order.worker = worker;
  order.lease = lease;
  order.cancelled = true;
  if (const auto trial = ledger_.trial_of(lease)) std::tie(order.condition, order.trial) = *trial;
  cancellations_.push_back(std::move(order));
}

bool Coordinator::on_flight_stored(const experiment::FlightKey& flight, Clock::time_point now) {
  if (!knows(flight)) return false;
  if (store(flight)) {
    ++flights_.count;
    stored_at_ = now;
  }
  return true;
}

void Coordinator::on_collector_paused(std::string why, Clock::time_point now) {
  collector_paused_ = std::move(why);
  collector_paused_at_ = now;
}

std::vector<Order> Coordinator::tick(Clock::time_point now) {
  tell_lost(ledger_.expire(now), now);
  if (const double elapsed_s = seconds(now - rates_at_); elapsed_s >= 0.5) {
    flights_.update(elapsed_s);
    steps_.update(elapsed_s);
    find_unserved(now);
    rates_at_ = now;
  }
  std::vector<Order> orders = std::exchange(cancellations_, {});
  if (now < grant_from_ || over()) return orders;
  for (Lease lease; ledger_.grant(now, lease);) {
    Order order{lease.worker, lease.id, lease.condition, lease.trial, lease.attempt, {}, false};
    for (const std::uint32_t agent : lease.agents) order.agents.push_back(experiment_.agents[agent].name);
    if (order.attempt > 1)
      spdlog::info("{} goes to worker {}, attempt {}", trial_name(order.condition, order.trial), order.worker,
                   order.attempt);
    orders.push_back(std::move(order));
  }
  return orders;
}

Progress Coordinator::progress(Clock::time_point now) const {
  Progress progress;
  progress.flights_total = ledger_.flights_total();
  progress.flights_stored = ledger_.flights_stored();
  progress.trials_pending = ledger_.count(TrialState::pending) + ledger_.count(TrialState::lost);
  progress.trials_leased = ledger_.count(TrialState::leased);
  progress.trials_done = ledger_.count(TrialState::done);
  progress.trials_failed = ledger_.count(TrialState::failed);
  progress.workers_alive = static_cast<std::uint32_t>(ledger_.workers_alive());
  progress.flights_per_s = flights_.per_s;
  progress.steps_per_s = steps_.per_s;
  if (!ledger_.finished()) progress.message = waiting_for(now);
  if (progress.message.empty() && !trouble_.empty() && now - trouble_at_ < trouble_shown) progress.message = trouble_;
  return progress;
}

bool Coordinator::over() const {
  const bool too_many_failed = options_.fail_fast > 0 && ledger_.count(TrialState::failed) >= options_.fail_fast;
  return ledger_.finished() || too_many_failed;
}

std::size_t Coordinator::number_of(const experiment::FlightKey& flight) const {
  const std::size_t trial = std::size_t{flight.condition} * experiment_.trials + flight.trial;
  return trial * experiment_.agents.size() + agent_index_.find(flight.agent)->second;
}

std::vector<experiment::FlightKey> Coordinator::lost_flights(const std::vector<bool>& is_there) const {
  std::vector<experiment::FlightKey> lost;
  std::size_t number = 0;
  for (std::uint32_t condition = 0; condition < experiment_.conditions.size(); ++condition)
    for (std::uint32_t trial = 0; trial < experiment_.trials; ++trial)
      for (std::uint32_t agent = 0; agent < experiment_.agents.size(); ++agent) {
        const bool found = is_there.at(number++);
        if (!found && ledger_.is_stored(condition, trial, agent))
          lost.push_back({condition, trial, experiment_.agents[agent].name});
      }
  return lost;
}

std::vector<std::string> Coordinator::failure_report() const {
  std::vector<std::string> lines;
  for (const Failure& failure : ledger_.failures())
    lines.push_back(fmt::format("{} (agents {}): {}", trial_name(failure.condition, failure.trial),
                                missing_agents(failure.condition, failure.trial), failure.reason));
  return lines;
}

bool Coordinator::knows(const experiment::FlightKey& flight) const {
  return flight.condition < experiment_.conditions.size() && flight.trial < experiment_.trials &&
         agent_index_.contains(flight.agent);
}

bool Coordinator::store(const experiment::FlightKey& flight) {
  const std::uint32_t agent = agent_index_.find(flight.agent)->second;
  const bool is_new = ledger_.flight_stored(flight.condition, flight.trial, agent);
  if (is_new) --flights_missing_[agent];
  return is_new;
}

std::string Coordinator::trial_name(std::uint32_t condition, std::uint32_t trial) const {
  return fmt::format("trial {} of condition {} ({})", trial, condition, experiment_.conditions[condition].name);
}

std::string Coordinator::trial_names(const std::vector<std::uint64_t>& leases) const {
  std::vector<std::string> names;
  for (const std::uint64_t lease : leases)
    if (const auto trial = ledger_.trial_of(lease); trial && names.size() < names_listed)
      names.push_back(trial_name(trial->first, trial->second));
  return fmt::format("{}{}", fmt::join(names, ", "),
                     leases.size() > names.size() ? fmt::format(" and {} more", leases.size() - names.size()) : "");
}

std::string Coordinator::missing_agents(std::uint32_t condition, std::uint32_t trial) const {
  std::vector<std::string_view> names;
  for (std::uint32_t agent = 0; agent < experiment_.agents.size(); ++agent)
    if (!ledger_.is_stored(condition, trial, agent)) names.emplace_back(experiment_.agents[agent].name);
  return fmt::format("{}", fmt::join(names, ", "));
}

/// What the run waits for; empty if for nothing.
std::string Coordinator::waiting_for(Clock::time_point now) const {
  if (std::string doubled = namesakes_.text(now); !doubled.empty()) return doubled;
  if (!collector_paused_.empty() && now - collector_paused_at_ < pause_shown) return collector_paused_;
  if (workers_.empty()) {
    const auto silence = now - worker_seen_;
    return silence < options_.patience
               ? ""
               : fmt::format("no worker for {:.0f} s; waiting for one to join", seconds(silence));
  }
  if (const auto silence = now - stored_at_; silence >= options_.patience)
    return fmt::format("{} finished flights have not been stored for {:.0f} s; waiting for aloft-metrics",
                       records_unconfirmed_, seconds(silence));
  if (!unserved_.empty() && now - unserved_since_ >= options_.patience) return unserved_;
  for (const auto& [name, worker] : workers_)
    if (!worker.waits_for.empty()) return fmt::format("worker {} waits for {}", name, worker.waits_for);
  return "";
}

void Coordinator::forget(std::string_view worker) {
  const auto at = workers_.find(worker);
  if (at == workers_.end()) return;
  records_unconfirmed_ -= at->second.records_unconfirmed;
  workers_.erase(at);
}

std::vector<bool> Coordinator::flies(const WorkerNews& news) const {
  if (news.flies_only.empty()) return {};
  std::vector<bool> flies(experiment_.agents.size(), false);
  for (const std::string& agent : news.flies_only)
    if (const auto at = agent_index_.find(agent); at != agent_index_.end()) flies[at->second] = true;
  return flies;
}

void Coordinator::find_unserved(Clock::time_point now) {
  std::string text;
  for (std::uint32_t agent = 0; agent < flights_missing_.size() && !workers_.empty(); ++agent) {
    const bool served = std::ranges::any_of(
        workers_, [&](const auto& entry) { return entry.second.flies.empty() || entry.second.flies[agent]; });
    if (served || flights_missing_[agent] == 0) continue;
    text = fmt::format("no worker flies agent {}; {} flights wait for one that does", experiment_.agents[agent].name,
                       flights_missing_[agent]);
    break;
  }
  if (text.empty() || unserved_.empty()) unserved_since_ = now;
  unserved_ = std::move(text);
}

void Coordinator::count_steps(const WorkerNews& news) {
  auto at = workers_.find(news.report.name);
  if (at == workers_.end()) at = workers_.try_emplace(std::string(news.report.name)).first;
  WorkerProgress& worker = at->second;
  if (worker.incarnation != news.report.incarnation) {
    worker.incarnation = news.report.incarnation;
    worker.steps_done = news.steps_done;  // steps before its first report do not count here
  }
  if (news.steps_done > worker.steps_done) steps_.count += news.steps_done - worker.steps_done;
  worker.steps_done = news.steps_done;
  records_unconfirmed_ += std::uint64_t{news.records_unconfirmed} - worker.records_unconfirmed;
  worker.records_unconfirmed = news.records_unconfirmed;
  worker.waits_for = news.waits_for;
}

void Coordinator::take_failures(const WorkerNews& news, Clock::time_point now) {
  for (const auto& [lease, reason] : news.failed_leases) {
    const std::uint64_t failed_before = ledger_.count(TrialState::failed);
    const std::uint64_t leased_before = ledger_.count(TrialState::leased);
    ledger_.lease_failed(lease, reason);
    const auto trial = ledger_.trial_of(lease);
    if (!trial || ledger_.count(TrialState::leased) == leased_before) continue;  // reported before
    const bool for_good = ledger_.count(TrialState::failed) > failed_before;
    trouble(fmt::format("{} failed {}on worker {}: {}", trial_name(trial->first, trial->second),
                        for_good ? "for good " : "", news.report.name, reason),
            now);
  }
}

void Coordinator::tell_lost(const std::vector<LostWorker>& lost, Clock::time_point now) {
  for (const LostWorker& worker : lost) {
    forget(worker.name);
    trouble(fmt::format("worker {} has been silent for {:.1f} s; {}", worker.name, seconds(worker.silent_for),
                        worker.leases.empty() ? "it flew nothing" : trial_names(worker.leases) + " to be flown again"),
            now);
  }
}

void Coordinator::trouble(std::string what, Clock::time_point now) {
  spdlog::warn("{}", what);
  trouble_ = std::move(what);
  trouble_at_ = now;
}

void Coordinator::Rate::update(double elapsed_s) {
  const double current = static_cast<double>(count - counted) / elapsed_s;
  per_s += (current - per_s) * (1.0 - std::exp(-elapsed_s / rate_memory_s));
  counted = count;
}

}  // namespace aloft::coordinator
