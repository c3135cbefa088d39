#include "tools/report/tournament_table.hpp"

#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <optional>

#include "tools/report/statistics_view.hpp"

namespace aloft::report {
namespace {

using nlohmann::json;

bool privileged(std::string_view type) {
  return agents::agent_type(type).privilege != agents::Privilege::none;
}

std::string heading(const ConditionTrials& condition) {
  if (condition.kind == experiment::WorldKind::measured) return condition.measured_file;
  return fmt::format("{:g} / {:g}", condition.bs_density_per_km2, condition.building_density_per_km2);
}

const json* row_of(const json& view, const std::string& agent) {
  if (view.is_null()) return nullptr;
  for (const json& row : view.at("agents"))
    if (row.at("name") == agent) return &row;
  return nullptr;
}

std::optional<double> gain_of(const json* row) {
  if (row == nullptr || row->at("gain").is_null()) return std::nullopt;
  return row->at("gain").at("mean").get<double>();
}

std::string gain_cell(const json* row, bool best) {
  const auto gain = gain_of(row);
  if (!gain) return "-";
  const json& ci = row->at("gain").at("ci95");
  const double half = (ci[1].get<double>() - ci[0].get<double>()) / 2.0;
  const std::string text = fmt::format("{:+.2f} ± {:.2f}", *gain, half);
  return best ? "**" + text + "**" : text;
}

std::string number_or_dash(const json& value, const char* format) {
  return value.is_null() ? "-" : fmt::format(fmt::runtime(format), value.get<double>());
}

/// Mean of one number over the generated conditions; none if any lacks it.
std::optional<double> mean_over(std::span<const ConditionTrials> conditions, const std::vector<json>& views,
                                const std::string& agent, const char* key) {
  double sum = 0.0;
  double count = 0.0;
  for (std::size_t i = 0; i < conditions.size(); ++i) {
    if (conditions[i].kind == experiment::WorldKind::measured) continue;
    const json* row = row_of(views[i], agent);
    if (row == nullptr || row->at(key).is_null()) return std::nullopt;
    sum += row->at(key).get<double>();
    ++count;
  }
  return count > 0.0 ? std::optional(sum / count) : std::nullopt;
}

/// The summed gains of an agent as a share of the planner's.
std::optional<double> headroom_share(std::span<const ConditionTrials> conditions, const std::vector<json>& views,
                                     const std::string& agent) {
  double gained = 0.0;
  double feasible = 0.0;
  for (std::size_t i = 0; i < conditions.size(); ++i) {
    if (conditions[i].kind == experiment::WorldKind::measured) continue;
    const auto gain = gain_of(row_of(views[i], agent));
    const auto best = gain_of(row_of(views[i], "planner"));
    if (!gain || !best) return std::nullopt;
    gained += *gain;
    feasible += *best;
  }
  return feasible > 0.0 ? std::optional(gained / feasible) : std::nullopt;
}

/// All agents of all conditions, in the order of display.
std::vector<const AgentTrials*> agents_of(std::span<const ConditionTrials> conditions) {
  std::vector<const AgentTrials*> agents;
  for (const ConditionTrials& condition : conditions)
    for (const AgentTrials& agent : condition.agents)
      if (std::none_of(agents.begin(), agents.end(), [&](const auto* other) { return other->name == agent.name; }))
        agents.push_back(&agent);
  std::stable_sort(agents.begin(), agents.end(),
                   [](const auto* a, const auto* b) { return shown_before(a->name, b->name); });
  return agents;
}

std::vector<json> views_of(std::span<const ConditionTrials> conditions) {
  std::vector<json> views;
  for (const ConditionTrials& condition : conditions) views.push_back(statistics_view(condition));
  return views;
}

/// Per condition the name of the agent without privilege that gains most.
std::vector<std::string> winners(const std::vector<json>& views, const std::vector<const AgentTrials*>& agents) {
  std::vector<std::string> names;
  for (const json& view : views) {
    std::string best;
    double most = 0.0;
    for (const AgentTrials* agent : agents) {
      const auto gain = privileged(agent->type) ? std::nullopt : gain_of(row_of(view, agent->name));
      if (!gain || *gain <= most) continue;
      most = *gain;
      best = agent->name;
    }
    names.push_back(best);
  }
  return names;
}

}  // namespace

std::string tournament_overview(std::span<const ConditionTrials> conditions, const StepCosts& costs) {
  const std::vector<json> views = views_of(conditions);
  const std::vector<const AgentTrials*> agents = agents_of(conditions);
  const std::vector<std::string> best = winners(views, agents);
  std::string head = "| agent |";
  std::string rule = "|---|";
  for (const ConditionTrials& condition : conditions) {
    head += fmt::format(" {} |", heading(condition));
    rule += "---|";
  }
  std::string text = head + " head-room closed | height changes | kJ | µs per step |\n" + rule + "---|---|---|---|\n";
  for (const AgentTrials* agent : agents) {
    text += fmt::format("| {}{} |", agent->name, privileged(agent->type) ? " *" : "");
    for (std::size_t i = 0; i < conditions.size(); ++i)
      text += fmt::format(" {} |", gain_cell(row_of(views[i], agent->name), best[i] == agent->name));
    const auto share = headroom_share(conditions, views, agent->name);
    const auto changes = mean_over(conditions, views, agent->name, "height_changes_mean");
    const auto energy = mean_over(conditions, views, agent->name, "energy_mean_kj");
    const auto cost = costs.find(agent->name);
    text += fmt::format(" {} | {} | {} | {} |\n", share ? fmt::format("{:.0f} %", 100.0 * *share) : "-",
                        changes ? fmt::format("{:.0f}", *changes) : "-", energy ? fmt::format("{:.1f}", *energy) : "-",
                        cost == costs.end() ? "-" : fmt::format("{:.2g}", cost->second));
  }
  return text;
}

std::string tournament_details(std::span<const ConditionTrials> conditions) {
  std::string text;
  for (const ConditionTrials& condition : conditions) {
    const json view = statistics_view(condition);
    if (view.is_null()) continue;
    text += fmt::format(
        "### {}\n\n| agent | trials | {} | 95 % interval | gain over min-height | 95 % interval | better in | "
        "head-room "
        "closed | height m | height changes | handovers | kJ |\n|---|---|---|---|---|---|---|---|---|---|---|---|\n",
        condition.kind == experiment::WorldKind::measured ? condition.label : heading(condition) + " per km²",
        condition.qos_unit());
    for (const json& row : view.at("agents")) {
      const json& gain = row.at("gain");
      text += fmt::format("| {} | {} | {:.2f} | [{:.2f}, {:.2f}] |", row.at("name").get<std::string>(),
                          row.at("trials").get<int>(), row.at("mean").get<double>(), row.at("ci95")[0].get<double>(),
                          row.at("ci95")[1].get<double>());
      if (gain.is_null())
        text += " - | - | - | - |";
      else
        text += fmt::format(" {:+.2f} | [{:+.2f}, {:+.2f}] | {:.0f} % | {} |", gain.at("mean").get<double>(),
                            gain.at("ci95")[0].get<double>(), gain.at("ci95")[1].get<double>(),
                            100.0 * gain.at("probability_of_improvement").get<double>(),
                            row.at("headroom_share").is_null()
                                ? "-"
                                : fmt::format("{:.0f} %", 100.0 * row.at("headroom_share").get<double>()));
      text += fmt::format(" {} | {} | {} | {} |\n", number_or_dash(row.at("height_mean_m"), "{:.1f}"),
                          number_or_dash(row.at("height_changes_mean"), "{:.1f}"),
                          number_or_dash(row.at("handovers_mean"), "{:.1f}"),
                          number_or_dash(row.at("energy_mean_kj"), "{:.1f}"));
    }
    text += '\n';
  }
  return text;
}

}  // namespace aloft::report
