#include "tools/live/replay.hpp"

#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <set>
#include <vector>

#include "common/base/build_info.hpp"
#include "common/base/error.hpp"
#include "tools/live/live_page.hpp"
#include "tools/report/agent_list.hpp"
#include "tools/report/flight_view.hpp"
#include "tools/report/statistics_view.hpp"
#include "tools/report/trials.hpp"

namespace aloft::live {

using nlohmann::json;

Replay::Replay(const std::filesystem::path& dir)
    : store_(store::ResultStore::open_for_reading(dir)), source_(std::filesystem::absolute(dir).string()) {}

json Replay::overview() const {
  const experiment::Experiment& experiment = store_.experiment();
  const std::vector<report::ConditionTrials> conditions = report::read_trials(store_);
  std::vector<std::set<std::uint32_t>> trials(conditions.size());
  for (const experiment::FlightKey& key : store_.keys()) trials.at(key.condition).insert(key.trial);
  json data{{"title", experiment.name},
            {"description", experiment.description},
            {"source",
             fmt::format("{}: experiment {}, seed {}; aloft {}", source_, experiment.id, experiment.seed, build_id())},
            {"agents", report::agent_list(conditions)},
            {"privilege_tiers", report::tier_list()},
            {"marks_explained", agents::marks_explained()},
            {"conditions", json::array()}};
  for (std::size_t i = 0; i < conditions.size(); ++i)
    data["conditions"].push_back({{"label", conditions[i].label},
                                  {"qos_name", conditions[i].qos_name()},
                                  {"qos_unit", conditions[i].qos_unit()},
                                  {"trials", trials[i]}});
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

json Replay::results() const {
  const experiment::Experiment& experiment = store_.experiment();
  json conditions = json::array();
  for (const report::ConditionTrials& condition : report::read_trials(store_)) {
    const json view = report::statistics_view(condition);
    conditions.push_back(view.is_null() ? json() : json{{"agents", view["agents"]}});
  }
  return {
      {"flights_stored", store_.count()},
      {"flights_expected", std::uint64_t{experiment.trials} * experiment.conditions.size() * experiment.agents.size()},
      {"conditions", std::move(conditions)}};
}

std::map<std::string, http::HttpRoute> Replay::routes() const {
  return {{"/data/overview", {[this](const http::HttpRequest&) { return json_answer(overview()); }}},
          {"/data/flight", {[this](const http::HttpRequest& request) {
             return json_answer(flight(number_of(request, "condition"), number_of(request, "trial")));
           }}},
          {"/data/results", {[this](const http::HttpRequest&) { return json_answer(results()); }}}};
}

}  // namespace aloft::live
