#include "tools/live/replay.hpp"

#include <fmt/format.h>

#include <ctime>
#include <nlohmann/json.hpp>
#include <set>
#include <vector>

#include "common/base/error.hpp"
#include "tools/live/live_page.hpp"
#include "tools/report/flight_view.hpp"
#include "tools/report/statistics_view.hpp"
#include "tools/report/trials.hpp"

namespace aloft::live {

using nlohmann::json;

namespace {

constexpr std::chrono::milliseconds results_period{1000};
/// Statistics of a run that goes on take at most one part in so many of a core.
constexpr int effort_divisor = 20;

/// What this thread has computed so far.
std::chrono::nanoseconds effort() {
  timespec used{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &used);
  return std::chrono::seconds(used.tv_sec) + std::chrono::nanoseconds(used.tv_nsec);
}

}  // namespace

Replay::Replay(const std::filesystem::path& dir)
    : store_(store::ResultStore::open_for_reading(dir)), source_(std::filesystem::absolute(dir).string()) {}

json Replay::overview() const {
  const experiment::Experiment& experiment = store_.experiment();
  std::vector<std::set<std::uint32_t>> trials(experiment.conditions.size());
  for (const experiment::FlightKey& key : store_.keys()) trials.at(key.condition).insert(key.trial);
  json data = overview_of(experiment);
  data["source"] = fmt::format("{}: {}", source_, data["source"].get<std::string>());
  for (std::size_t i = 0; i < trials.size(); ++i) data["conditions"][i]["trials"] = trials[i];
  return data;
}

json Replay::flight(std::uint32_t condition, std::uint32_t trial) const {
  const std::size_t conditions = store_.experiment().conditions.size();
  if (condition >= conditions)
    throw InputError("there is no condition {}; allowed: 0 to {}", condition, conditions - 1);
  if (!report::trial_to_show(store_, condition, trial))
    throw InputError("no flight of trial {} is stored for condition {}", trial, condition);
  return report::flight_view(store_, condition, trial, report::Quantities::all);
}

const json& Replay::results() {
  const std::size_t stored = store_.count();
  const Clock::time_point start = Clock::now();
  if (results_.is_null() || (stored != results_.at("flights_stored") && start >= results_due_)) {
    const std::chrono::nanoseconds before = effort();
    results_ = computed_results(stored);
    results_due_ = start + effort_divisor * (effort() - before);
  }
  return results_;
}

json Replay::computed_results(std::size_t stored) const {
  const experiment::Experiment& experiment = store_.experiment();
  json conditions = json::array();
  for (const report::ConditionTrials& condition : report::read_trials(store_)) {
    const json view = report::statistics_view(condition);
    conditions.push_back(view.is_null() ? json() : json{{"agents", view["agents"]}});
  }
  return {
      {"flights_stored", stored},
      {"flights_expected", std::uint64_t{experiment.trials} * experiment.conditions.size() * experiment.agents.size()},
      {"conditions", std::move(conditions)}};
}

std::map<std::string, http::HttpRoute> Replay::routes() {
  const auto results_now = [this](const http::HttpRequest&) { return json_answer(results()); };
  return {{"/data/overview", {[this](const http::HttpRequest&) { return json_answer(overview()); }}},
          {"/data/flight", {[this](const http::HttpRequest& request) {
             return json_answer(flight(number_of(request, "condition"), number_of(request, "trial")));
           }}},
          {"/data/results", {results_now}},
          {"/events/results", {results_now, false, results_period}}};
}

}  // namespace aloft::live
