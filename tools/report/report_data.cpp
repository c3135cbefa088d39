#include "tools/report/report_data.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "common/base/build_info.hpp"
#include "common/base/digest.hpp"
#include "common/base/error.hpp"
#include "common/base/nearest.hpp"
#include "common/base/number_text.hpp"
#include "tools/report/agent_list.hpp"
#include "tools/report/claims.hpp"
#include "tools/report/flight_view.hpp"
#include "tools/report/paper.hpp"
#include "tools/report/published.hpp"
#include "tools/report/statistics_view.hpp"

namespace aloft::report {
namespace {

using nlohmann::json;

constexpr const char* selection_rival = "constant-120";

/// One condition of one run, with all its trials and with the selected ones.
struct ReportCondition {
  std::size_t run = 0;
  std::uint32_t index = 0;  ///< in the run's experiment
  ConditionTrials all;
  std::optional<ConditionTrials> selected;
};

std::vector<ReportCondition> read_conditions(std::span<const store::ResultStore> runs) {
  std::vector<ReportCondition> conditions;
  std::vector<ConditionTrials> all;
  for (std::size_t run = 0; run < runs.size(); ++run) {
    std::uint32_t index = 0;
    for (ConditionTrials& trials : read_trials(runs[run])) {
      all.push_back(trials);
      conditions.push_back({run, index++, std::move(trials), std::nullopt});
    }
  }
  const std::string learner = published_learner(all);
  for (ReportCondition& condition : conditions) condition.selected = selected(condition.all, learner, selection_rival);
  return conditions;
}

json experiment_facts(const store::ResultStore& run) {
  const experiment::Experiment& experiment = run.experiment();
  return {
      {"name", experiment.name},
      {"description", experiment.description},
      {"id", experiment.id},
      {"seed", experiment.seed},
      {"trials", experiment.trials},
      {"flights_stored", run.keys().size()},
      {"flights_expected", std::uint64_t{experiment.trials} * experiment.conditions.size() * experiment.agents.size()},
      {"digest", run.digest()}};
}

json missing_lines(const std::vector<ReportCondition>& conditions, bool name_experiment) {
  json lines = json::array();
  for (const ReportCondition& condition : conditions) {
    std::string agents;
    std::uint64_t missing = 0;
    for (const AgentTrials& agent : condition.all.agents) {
      const std::size_t lacking = condition.all.trials_expected - agent.trials.size();
      if (lacking == 0) continue;
      missing += lacking;
      agents += fmt::format("{}{} ({} of {})", agents.empty() ? "" : ", ", agent.name, lacking,
                            condition.all.trials_expected);
    }
    if (missing == 0) continue;
    lines.push_back(fmt::format("{}{}: {} of {} flights are missing: {}",
                                name_experiment ? condition.all.experiment + ", " : "", condition.all.label, missing,
                                std::uint64_t{condition.all.trials_expected} * condition.all.agents.size(), agents));
  }
  return lines;
}

/// Whether some flight has this metric.
bool is_known(const flight::Metric& metric, std::span<const ReportCondition> conditions) {
  return std::ranges::any_of(conditions, [&](const ReportCondition& condition) {
    return std::ranges::any_of(condition.all.agents, [&](const AgentTrials& agent) {
      const auto values = agent.metrics.find(metric.key);
      return values != agent.metrics.end() &&
             std::ranges::any_of(values->second, [](double value) { return std::isfinite(value); });
    });
  });
}

/// All metrics but the quality and those that no flight has, in the order of the columns.
json metric_list(std::span<const ReportCondition> conditions) {
  json list = json::array();
  for (const flight::Metric& metric : flight::other_metrics())
    if (!metric.optional || is_known(metric, conditions))
      list.push_back({{"name", metric.name},
                      {"title", title_of(metric)},
                      {"decimals", metric.report_decimals},
                      {"better", metric.better == flight::Better::higher  ? json("higher")
                                 : metric.better == flight::Better::lower ? json("lower")
                                                                          : json()}});
  return list;
}

/// The last part of a swept path: "worlds.0.steps" is "steps".
std::string parameter_of(const std::string& path) {
  return path.substr(path.rfind('.') + 1);
}

/// The values that a condition has of all parameters its experiment sweeps, if they are numbers.
json swept_values(const store::ResultStore& run, const ReportCondition& condition) {
  json values = json::object();
  for (const experiment::Condition& other : run.experiment().conditions)
    for (const auto& [path, ignored] : other.parameters.items()) {
      const json value = condition.all.world_parameters.value(parameter_of(path), json());
      if (value.is_number()) values[parameter_of(path)] = value;
    }
  return values;
}

json parameter_titles(std::span<const store::ResultStore> runs) {
  json titles = json::object();
  for (const store::ResultStore& run : runs)
    for (const experiment::Condition& condition : run.experiment().conditions)
      for (const auto& [path, ignored] : condition.parameters.items())
        titles[parameter_of(path)] = title_of_parameter(parameter_of(path));
  return titles;
}

json condition_data(const store::ResultStore& run, const ReportCondition& condition, const Choice& choice) {
  const auto trial = trial_to_show(run, condition.index, choice.trial);
  return {{"experiment", condition.run},
          {"name", condition.all.name},
          {"label", condition.all.label},
          {"place", condition.all.place},
          {"site_map", condition.all.site_map},
          {"parameters", swept_values(run, condition)},
          {"world", sha256_hex(condition.all.world()).substr(0, 16)},
          {"kind", condition.all.kind == experiment::WorldKind::measured ? "measured" : "generated"},
          {"qos_name", condition.all.qos_name()},
          {"qos_unit", condition.all.qos_unit()},
          {"views",
           {{"all", statistics_view(condition.all)},
            {"selected", condition.selected ? statistics_view(*condition.selected) : json()}}},
          {"flight", trial ? flight_view(run, condition.index, *trial) : json()}};
}

json published_rows(const std::vector<ReportCondition>& conditions, bool name_experiment) {
  json rows = json::array();
  for (const ReportCondition& condition : conditions) {
    if (!why_not_the_papers(condition.all).empty()) continue;
    for (const json& value : published().at("values")) {
      if (!belongs_to(value, condition.all)) continue;
      const json all = beside_published(value, condition.all);
      if (all.is_null()) continue;
      const bool ratio = value.contains("over");
      std::string quantity = value["statistic"] == "mean" ? "Mean" : "Median";
      if (ratio) {
        quantity += " over that of ";
        for (const json& other : value["over"])
          quantity += other.get<std::string>() + (other == value["over"].back() ? "" : ", ");
      }
      rows.push_back(
          {{"label", (name_experiment ? condition.all.experiment + ", " : "") + condition.all.label},
           {"agent", value["agent"]},
           {"quantity", quantity},
           {"unit", ratio ? "" : condition.all.qos_unit()},
           {"published", value["value"]},
           {"plus_minus", value.value("plus_minus", json())},
           {"tolerance", printed_tolerance(value)},
           {"views",
            {{"all", all}, {"selected", condition.selected ? beside_published(value, *condition.selected) : json()}}}});
    }
  }
  return rows;
}

std::vector<ConditionTrials> trials_of(const std::vector<ReportCondition>& conditions, bool only_selected) {
  std::vector<ConditionTrials> trials;
  for (const ReportCondition& condition : conditions) {
    if (!only_selected) trials.push_back(condition.all);
    if (only_selected && condition.selected) trials.push_back(*condition.selected);
  }
  return trials;
}

/// The parts of the run that are not compared with the paper, and why.
json left_out(const std::vector<ReportCondition>& conditions, bool only_selected) {
  return papers_share(trials_of(conditions, only_selected)).left_out;
}

json claims_of(const std::vector<ReportCondition>& conditions, bool only_selected) {
  json claims = json::array();
  for (const Claim& claim : judge_claims(trials_of(conditions, only_selected), published().at("claims")))
    claims.push_back({{"text", claim.text},
                      {"reading", claim.reading},
                      {"verdict", verdict_name(claim.verdict)},
                      {"reason", claim.reason},
                      {"details", claim.details}});
  return claims;
}

std::size_t find_condition(const std::vector<ReportCondition>& conditions, const std::string& wanted) {
  if (const auto number = number_in<std::size_t>(wanted); number && *number < conditions.size()) return *number;
  std::vector<std::string> names;
  for (std::size_t i = 0; i < conditions.size(); ++i) {
    if (conditions[i].all.name == wanted) return i;
    names.push_back(conditions[i].all.name);
  }
  throw InputError("--condition: there is no condition '{}'.{} Allowed: 0 to {}, or one of: {}", wanted,
                   did_you_mean(wanted, names), conditions.size() - 1, fmt::join(names, ", "));
}

std::size_t condition_to_show(const json& conditions, const std::vector<ReportCondition>& known, const Choice& choice) {
  if (!choice.condition.empty()) {
    const std::size_t index = find_condition(known, choice.condition);
    if (choice.trial && conditions[index]["flight"].is_null())
      throw InputError("--trial: no flight of trial {} is stored for condition {}; trials of this experiment: 0 to {}",
                       *choice.trial, known[index].all.name, known[index].all.trials_expected - 1);
    return index;
  }
  for (std::size_t i = 0; i < conditions.size(); ++i)
    if (!conditions[i]["flight"].is_null()) return i;
  if (choice.trial)
    throw InputError(
        "--trial: no flight of trial {} is stored in any condition; leave it out to see the first one that is",
        *choice.trial);
  return 0;
}

}  // namespace

nlohmann::json report_data(std::span<const store::ResultStore> runs, const Choice& choice) {
  const std::vector<ReportCondition> conditions = read_conditions(runs);
  const bool several = runs.size() > 1;
  const std::vector<ConditionTrials> all = trials_of(conditions, false);
  const std::string learner = published_learner(all);
  json data{{"version", 1},
            {"title", several ? "Adaptive height of cellular-connected UAVs" : runs.front().experiment().name},
            {"build", fmt::format("aloft {}", build_id())},
            {"experiments", json::array()},
            {"missing", missing_lines(conditions, several)},
            {"agents", agent_list(all)},
            {"metrics", metric_list(conditions)},
            {"parameter_titles", parameter_titles(runs)},
            {"privilege_tiers", tier_list()},
            {"marks_explained", agents::marks_explained()},
            {"learner", learner.empty() ? json() : json(learner)},
            {"conditions", json::array()},
            {"published",
             {{"source", published().at("source")},
              {"least_trials", least_trials()},
              {"rows", published_rows(conditions, several)},
              {"left_out", {{"all", left_out(conditions, false)}, {"selected", left_out(conditions, true)}}}}},
            {"claims", {{"all", claims_of(conditions, false)}, {"selected", claims_of(conditions, true)}}}};
  for (const store::ResultStore& run : runs) data["experiments"].push_back(experiment_facts(run));
  for (const ReportCondition& condition : conditions)
    data["conditions"].push_back(condition_data(runs[condition.run], condition, choice));
  data["shown_condition"] = condition_to_show(data["conditions"], conditions, choice);
  return data;
}

}  // namespace aloft::report
