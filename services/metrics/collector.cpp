#include "services/metrics/collector.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "common/base/digest.hpp"
#include "common/base/error.hpp"
#include "common/base/limits.hpp"
#include "common/base/seconds.hpp"

namespace aloft::metrics {
namespace {

bool within(double value, double limit) {
  return std::isfinite(value) && std::abs(value) <= limit;
}

/// What is wrong with a decoded flight, or nothing.
std::optional<std::string> flaw(const flight::FlightRecord& flight) {
  if (flight.steps.empty() || flight.steps.size() > limits::steps)
    return fmt::format("it has {} steps; allowed: 1 to {}", flight.steps.size(), limits::steps);
  for (std::size_t i = 0; i < flight.steps.size(); ++i) {
    const flight::StepRecord& step = flight.steps[i];
    if (step.step != i + 1) return fmt::format("step {} stands where step {} is due", step.step, i + 1);
    if (step.flown_by >= flight.pilots.size()) return fmt::format("step {} names no pilot", step.step);
    if (!within(step.x_m, limits::distance_m) || !within(step.y_m, limits::distance_m) ||
        !within(step.height_m, limits::height_m))
      return fmt::format("the position of step {} is not finite or out of range", step.step);
    if (!std::isfinite(step.qos) || step.qos < 0.0 || !std::isfinite(step.reward) ||
        !std::isfinite(step.serving_sinr_db))
      return fmt::format("the quality of step {} is negative or not finite", step.step);
  }
  return std::nullopt;
}

}  // namespace

Collector::Collector(const experiment::Experiment& experiment, Commit commit, Instruments& instruments,
                     CollectorOptions options)
    : experiment_(experiment), commit_(std::move(commit)), instruments_(instruments), options_(options) {}

std::optional<std::string> Collector::offer(Record record, Clock::time_point now) {
  std::size_t steps = 0;
  if (auto refused = check(record, steps)) return refused;
  const std::size_t bytes = record.trace.size() + record.memory.size();
  const bool no_room = !queue_.empty() && queue_bytes_ + bytes > options_.queue_bytes;
  const bool queued = std::ranges::any_of(
      queue_, [&](const Record& other) { return other.key == record.key && other.trace == record.trace; });
  if (no_room || queued) return std::nullopt;  // it will come again
  if (queue_.empty()) oldest_ = now;
  queue_bytes_ += bytes;
  queue_steps_.push_back(steps);
  queue_.push_back(std::move(record));
  return std::nullopt;
}

std::vector<Acknowledgement> Collector::commit_due(Clock::time_point now, bool flush) {
  const auto due = next_due();
  if (!due || (now < *due && !flush)) return {};
  std::vector<store::Stored> stored;
  const auto started = Clock::now();
  try {
    stored = commit_(queue_);
  } catch (const IntegrityError&) {
    throw;
  } catch (const store::ResultsGone&) {
    throw;
  } catch (const std::logic_error&) {
    throw;
  } catch (const std::exception& error) {
    paused_because_ = fmt::format("{} flights wait, nothing can be stored: {}", queue_.size(), error.what());
    retry_at_ = now + options_.retry_time;
    instruments_.set_paused(true);
    return {};
  }
  instruments_.committed(seconds(Clock::now() - started));
  instruments_.set_paused(false);
  paused_because_.clear();

  std::vector<Acknowledgement> acknowledgements;
  acknowledgements.reserve(queue_.size());
  for (std::size_t i = 0; i < queue_.size(); ++i) {
    const bool is_new = stored.at(i) == store::Stored::added;
    if (is_new)
      instruments_.stored(queue_steps_[i]);
    else
      instruments_.duplicate();
    acknowledgements.push_back({queue_[i].episode_id, std::move(queue_[i].key), sha256_hex(queue_[i].trace), is_new});
  }
  queue_.clear();
  queue_steps_.clear();
  queue_bytes_ = 0;
  return acknowledgements;
}

std::optional<Clock::time_point> Collector::next_due() const {
  if (queue_.empty()) return std::nullopt;
  if (!paused_because_.empty()) return retry_at_;
  return queue_.size() >= options_.batch_records ? oldest_ : oldest_ + options_.batch_time;
}

std::optional<std::string> Collector::check(const Record& record, std::size_t& steps) {
  if (record.experiment_id != experiment_.id)
    return refuse(Rejection::other_experiment, record,
                  fmt::format("it belongs to experiment '{}'", record.experiment_id));
  if (record.key.condition >= experiment_.conditions.size() || record.key.trial >= experiment_.trials)
    return refuse(Rejection::unknown_flight, record,
                  fmt::format("the experiment has {} conditions of {} trials", experiment_.conditions.size(),
                              experiment_.trials));
  const std::size_t agent = experiment_.agent_index(record.key.agent);
  if (agent == experiment_.agents.size())
    return refuse(Rejection::unknown_flight, record, "the experiment has no such agent");
  if (record.episode_id != experiment::episode_id(experiment_, record.key))
    return refuse(Rejection::unknown_flight, record, "its episode id does not fit");
  if ((experiment_.agents[agent].lineages() > 0) == record.memory.empty())
    return refuse(Rejection::bad_trace, record,
                  record.memory.empty() ? "the agent's memory is missing" : "its agent has no memory to keep");
  try {
    const flight::FlightRecord flight = store::decode_trace(record.trace);
    if (const auto wrong = flaw(flight)) return refuse(Rejection::bad_trace, record, *wrong);
    steps = flight.steps.size();
  } catch (const IntegrityError& error) {
    return refuse(Rejection::bad_trace, record, error.what());
  }
  return std::nullopt;
}

std::string Collector::refuse(Rejection reason, const Record& record, std::string_view why) {
  instruments_.rejected(reason);
  return fmt::format("refused a record of worker '{}' (condition {}, trial {}, agent '{}'): {}", record.worker,
                     record.key.condition, record.key.trial, record.key.agent, why);
}

Collector::Commit commit_to(store::ResultStore& store) {
  return [&store](const std::vector<Record>& records) {
    std::vector<store::Stored> stored;
    store.batch([&] {
      for (const Record& record : records) stored.push_back(store.add(record.key, record.trace, record.memory));
    });
    return stored;
  };
}

}  // namespace aloft::metrics
