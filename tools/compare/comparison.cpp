#include "tools/compare/comparison.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "common/base/error.hpp"
#include "common/base/plain_text.hpp"
#include "common/experiment/identity.hpp"

namespace aloft::compare {
namespace {

using experiment::Interval;
using Flights = std::map<std::uint32_t, const store::FlightSummary*>;  // by trial
using Cell = std::pair<std::uint32_t, std::string>;                    // condition, agent

std::map<Cell, Flights> by_cell(const Side& side) {
  std::map<Cell, Flights> cells;
  for (const store::FlightSummary& flight : side.flights)
    cells[{flight.key.condition, flight.key.agent}][flight.key.trial] = &flight;
  return cells;
}

const experiment::Condition* same_condition(const experiment::Experiment& experiment,
                                            const experiment::Condition& condition) {
  for (const experiment::Condition& other : experiment.conditions)
    if (other.name == condition.name && other.kind == condition.kind) return &other;
  return nullptr;
}

double qos_mean(const store::FlightSummary& flight) {
  return flight.metrics.number(flight::quality);
}

std::vector<double> all_qos(const Flights& flights) {
  std::vector<double> qos;
  for (const auto& [trial, flight] : flights) qos.push_back(qos_mean(*flight));
  return qos;
}

void compare_pairs(AgentComparison& row, const Flights& a, const Flights& b, std::uint64_t seed) {
  std::vector<double> qos_a;
  std::vector<double> qos_b;
  std::vector<double> difference;
  for (const auto& [trial, flight] : a) {
    const auto other = b.find(trial);
    if (other == b.end()) continue;
    qos_a.push_back(qos_mean(*flight));
    qos_b.push_back(qos_mean(*other->second));
    difference.push_back(qos_b.back() - qos_a.back());
  }
  row.flights_a = row.flights_b = difference.size();
  row.qos_mean_a = experiment::mean(qos_a);
  row.qos_mean_b = experiment::mean(qos_b);
  row.difference = experiment::mean(difference);
  const Interval ci = experiment::bootstrap_ci95(difference, seed);
  if (ci.known()) row.difference_ci95 = ci;
}

/// Without an interval, all values of the sample (two or more) are equal, so that the mean is exact.
Interval interval_or_mean(const std::vector<double>& sample, double mean, std::uint64_t seed) {
  const Interval ci = experiment::bootstrap_ci95(sample, seed);
  return ci.known() ? ci : Interval{mean, mean};
}

void compare_means(AgentComparison& row, const Flights& a, const Flights& b, std::uint64_t seed) {
  const std::vector<double> qos_a = all_qos(a);
  const std::vector<double> qos_b = all_qos(b);
  row.flights_a = qos_a.size();
  row.flights_b = qos_b.size();
  row.qos_mean_a = experiment::mean(qos_a);
  row.qos_mean_b = experiment::mean(qos_b);
  row.difference = row.qos_mean_b - row.qos_mean_a;
  if (qos_a.size() < 2 || qos_b.size() < 2) return;
  const Interval ci_a = interval_or_mean(qos_a, row.qos_mean_a, seed);
  const Interval ci_b = interval_or_mean(qos_b, row.qos_mean_b, seed);
  if (ci_a.low == ci_a.high && ci_b.low == ci_b.high) return;
  row.difference_ci95 = {
      row.difference - std::hypot(row.qos_mean_b - ci_b.low, ci_a.high - row.qos_mean_a),
      row.difference + std::hypot(ci_b.high - row.qos_mean_b, row.qos_mean_a - ci_a.low),
  };
}

std::string names(const experiment::Experiment& experiment) {
  std::vector<std::string> conditions;
  std::vector<std::string> agents;
  conditions.reserve(experiment.conditions.size());
  agents.reserve(experiment.agents.size());
  for (const auto& condition : experiment.conditions) conditions.push_back(condition.name);
  for (const auto& agent : experiment.agents) agents.push_back(agent.name);
  return fmt::format("conditions {}; agents {}", excerpt(fmt::format("{}", fmt::join(conditions, ", "))),
                     excerpt(fmt::format("{}", fmt::join(agents, ", "))));
}

/// Counts of flights that both sides have and where they first differ.
void count(Comparison& comparison, AgentComparison& row, const Flights& a, const Flights& b) {
  for (const auto& [trial, flight] : a) {
    const auto other = b.find(trial);
    if (other == b.end()) continue;
    ++row.in_both;
    if (flight->digest == other->second->digest)
      ++row.identical;
    else if (!comparison.first_different)
      comparison.first_different = DifferentFlight{flight->key, other->second->key};
  }
  comparison.in_both += row.in_both;
  comparison.identical += row.identical;
}

}  // namespace

Comparison compare(const Side& a, const Side& b) {
  Comparison comparison;
  comparison.same_experiment = a.experiment.id == b.experiment.id;
  comparison.paired = a.experiment.seed == b.experiment.seed;
  const auto cells_a = by_cell(a);
  const auto cells_b = by_cell(b);
  for (const experiment::Condition& condition : a.experiment.conditions) {
    const experiment::Condition* other = same_condition(b.experiment, condition);
    if (other == nullptr) continue;
    for (const agents::AgentSpec& agent : a.experiment.agents) {
      const auto flights_a = cells_a.find({condition.index, agent.name});
      const auto flights_b = cells_b.find({other->index, agent.name});
      if (flights_a == cells_a.end() || flights_b == cells_b.end()) continue;
      AgentComparison row;
      row.condition = condition.name;
      row.agent = agent.name;
      row.privilege = std::max(agent.privilege(), b.experiment.agent(agent.name).privilege());
      row.kind = condition.kind;
      row.paired = comparison.paired;
      count(comparison, row, flights_a->second, flights_b->second);
      if (row.paired && row.in_both == 0) continue;
      (row.paired ? compare_pairs : compare_means)(row, flights_a->second, flights_b->second, a.experiment.seed);
      comparison.agents.push_back(std::move(row));
    }
  }
  if (comparison.agents.empty())
    throw InputError(
        "the two result folders share no flights to compare. First: {} ({} flights). Second: {} "
        "({} flights). Conditions and agents are matched by name; run both with the same ones.",
        names(a.experiment), a.flights.size(), names(b.experiment), b.flights.size());
  comparison.only_a = a.flights.size() - comparison.in_both;
  comparison.only_b = b.flights.size() - comparison.in_both;
  return comparison;
}

std::vector<SettingDifference> setting_differences(const experiment::Experiment& a, const experiment::Experiment& b,
                                                   std::size_t limit) {
  const auto at = [](const nlohmann::json& document, const nlohmann::json::json_pointer& path) {
    return document.contains(path) ? document.at(path).dump() : std::string("-");
  };
  const nlohmann::json settings_a = experiment::what_counts(a.canonical);
  const nlohmann::json settings_b = experiment::what_counts(b.canonical);
  std::vector<SettingDifference> differences;
  for (const auto& change : nlohmann::json::diff(settings_a, settings_b)) {
    if (differences.size() == limit) break;
    const auto path = change.at("path").get<std::string>();
    const nlohmann::json::json_pointer pointer(path);
    // An entry appended to a list has the path "/list/-", which has no value of its own.
    const bool appended = path.size() >= 2 && path.compare(path.size() - 2, 2, "/-") == 0;
    differences.push_back({path, appended ? "-" : at(settings_a, pointer),
                           change.contains("value") ? change["value"].dump() : std::string("-")});
  }
  return differences;
}

}  // namespace aloft::compare
