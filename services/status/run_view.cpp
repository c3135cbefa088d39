#include "services/status/run_view.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>

#include "common/base/error.hpp"
#include "common/base/json_text.hpp"
#include "common/base/seconds.hpp"
#include "common/bus/answer_times.hpp"

namespace aloft::status {
namespace {

using Json = nlohmann::ordered_json;

constexpr auto forget_leavers_after = std::chrono::seconds(10);
constexpr auto forget_lost_after = std::chrono::minutes(10);
constexpr auto rate_window = std::chrono::seconds(5);

/// To a tenth: more digits would only flicker.
double tenths(double value) {
  return std::round(value * 10.0) / 10.0;
}

// Words for the enumerators of the IDL, in their order.
constexpr std::array<std::string_view, 4> run_states{"running", "stopping", "finished", "failed"};
constexpr std::array<std::string_view, 3> collector_states{"storing", "paused", "failed"};
constexpr std::array<std::string_view, 4> agent_states{"ready", "flying", "shadow", "stopped"};

template <typename State, std::size_t n>
std::string_view word_for(State state, const std::array<std::string_view, n>& words) {
  const auto index = static_cast<std::size_t>(state);
  return index < n ? words[index] : "unknown";
}

/// `since`: seconds since the worker's status.
Json to_json(const wire::AgentNews& agent, double since) {
  const double silent_s = agent.silent_s() + since;
  return {{"agent", wire::view(agent.agent())},
          {"type", wire::view(agent.type())},
          {"process", wire::view(agent.process())},
          {"state", silent_s > lost_after_s ? "lost" : word_for(agent.state(), agent_states)},
          {"silent_s", tenths(silent_s)},
          {"flights", agent.flights()}};
}

}  // namespace

void RunView::hear(const wire::RunControl& control, Clock::time_point /*now*/) {
  if (!experiment_.empty()) return;
  try {
    const Json experiment = parse_json(wire::view(control.experiment_json()), "RunControl");
    if (experiment.is_object() && experiment.contains("name") && experiment["name"].is_string())
      experiment_ = experiment["name"];
  } catch (const InputError&) {  // NOLINT: processes that would fly it report it
  }
}

void RunView::hear(const wire::RunStatus& status, Clock::time_point now) {
  run_ = status;
  run_heard_ = now;
  pace_.update(status.flights_stored(), !wire::view(status.message()).empty(), now);
}

void RunView::hear(const wire::WorkerStatus& status, Clock::time_point now) {
  Worker& worker = workers_[std::string(wire::view(status.worker()))];
  if (worker.status.incarnation() != status.incarnation()) worker.counts.clear();
  worker.status = status;
  worker.heard = now;
  worker.counts.push_back({now, status.flights_done(), status.steps_done()});
  while (worker.counts.size() > 2 && now - worker.counts[1].at >= rate_window) worker.counts.pop_front();
}

void RunView::hear(const wire::CollectorStatus& status, Clock::time_point /*now*/) {
  collector_ = status;
}

void RunView::forget_old(Clock::time_point now) {
  std::erase_if(workers_, [&](const auto& entry) {
    const auto silence = now - entry.second.heard;
    return silence > forget_lost_after || (entry.second.status.capacity() == 0 && silence > forget_leavers_after);
  });
}

bool RunView::complete() const {
  return run_ && collector_ && workers_.size() >= run_->workers_alive();
}

Json RunView::to_json(const Worker& worker, Clock::time_point now) {
  const wire::WorkerStatus& status = worker.status;
  const double silent_s = seconds(now - worker.heard);
  const Count& first = worker.counts.front();
  const Count& last = worker.counts.back();
  const double span_s = seconds(last.at - first.at);
  const auto rate = [&](std::uint64_t from, std::uint64_t to) {
    return span_s > 0.0 && to > from ? tenths(static_cast<double>(to - from) / span_s) : 0.0;
  };
  Json leases = Json::array();
  for (const std::uint64_t lease : status.leases()) leases.push_back(fmt::format("{:016x}", lease));
  Json agents = Json::array();
  for (const wire::AgentNews& agent : status.agents()) agents.push_back(status::to_json(agent, silent_s));
  Json failures = Json::array();
  for (const wire::LeaseFailure& failure : status.failures())
    failures.push_back(
        {{"lease", fmt::format("{:016x}", failure.lease_id())}, {"reason", wire::view(failure.reason())}});
  // Null until a command came, and from 1 s on: JSON has no infinity.
  const auto answer_ms = [&](double share) -> Json {
    const double within_s = bus::answered_within_s(status.answer_counts(), share);
    return std::isfinite(within_s) ? Json(std::round(within_s * 1e6) / 1e3) : Json();
  };
  return {{"worker", wire::view(status.worker())},
          {"host", wire::view(status.host())},
          {"pid", status.pid()},
          {"state", status.capacity() == 0    ? "left"
                    : silent_s > lost_after_s ? "lost"
                                              : "alive"},
          {"silent_s", tenths(silent_s)},
          {"capacity", status.capacity()},
          {"leases", std::move(leases)},
          {"agents", std::move(agents)},
          {"flights_done", status.flights_done()},
          {"flights_per_s", rate(first.flights, last.flights)},
          {"steps_done", status.steps_done()},
          {"steps_per_s", rate(first.steps, last.steps)},
          {"answer_p50_ms", answer_ms(0.5)},
          {"answer_p99_ms", answer_ms(0.99)},
          {"records_unconfirmed", status.records_unconfirmed()},
          {"drops", status.drops()},
          {"missing", wire::view(status.missing())},
          {"failures", std::move(failures)}};
}

Json RunView::to_json(Clock::time_point now) const {
  const wire::RunStatus run = run_.value_or(wire::RunStatus());
  Json eta;
  if (run_ && run.flights_per_s() > 0.0 && !pace_.blocked_for(now))
    eta = std::round(static_cast<double>(run.flights_total() - std::min(run.flights_stored(), run.flights_total())) /
                     run.flights_per_s());
  Json workers = Json::array();
  for (const auto& [name, worker] : workers_) workers.push_back(to_json(worker, now));
  const std::string_view experiment_id = run_ ? wire::view(run_->experiment_id())
                                         : workers_.empty()
                                             ? std::string_view()
                                             : wire::view(workers_.begin()->second.status.experiment_id());
  return {{"run", name_},
          {"experiment", experiment_},
          {"experiment_id", experiment_id},
          {"middleware", middleware_},
          {"state", run_ ? word_for(run.state(), run_states) : "unknown"},
          {"silent_s", run_ ? Json(tenths(seconds(now - run_heard_))) : Json()},
          {"flights_total", run.flights_total()},
          {"flights_stored", run.flights_stored()},
          {"flights_per_s", tenths(run.flights_per_s())},
          {"steps_per_s", tenths(run.steps_per_s())},
          {"eta_s", std::move(eta)},
          {"trials",
           {{"pending", run.trials_pending()},
            {"leased", run.trials_leased()},
            {"done", run.trials_done()},
            {"failed", run.trials_failed()}}},
          {"message", wire::view(run.message())},
          {"collector",
           {{"state", collector_ ? word_for(collector_->state(), collector_states) : "unknown"},
            {"message", collector_ ? wire::view(collector_->message()) : std::string_view()}}},
          {"workers", std::move(workers)}};
}

}  // namespace aloft::status
