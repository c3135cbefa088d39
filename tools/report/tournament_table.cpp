#include "tools/report/tournament_table.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <optional>

#include "tools/report/agent_list.hpp"
#include "tools/report/statistics_view.hpp"

namespace aloft::report {
namespace {

using nlohmann::json;

std::string heading(const ConditionTrials& condition) {
  if (condition.kind == experiment::WorldKind::measured) return condition.measured_file + ", Mbit/s";
  return fmt::format("{:g} / {:g}", condition.bs_density_per_km2, condition.building_density_per_km2);
}

/// All flights over the same worlds, of one run or several.
struct Column {
  const ConditionTrials* condition = nullptr;  ///< of the first run
  std::vector<json> views;

  /// The agent's row in the first run that it flew in.
  [[nodiscard]] const json* row(const std::string& agent) const {
    for (const json& view : views)
      if (!view.is_null())
        for (const json& row : view.at("agents"))
          if (row.at("name") == agent) return &row;
    return nullptr;
  }
  [[nodiscard]] bool generated() const { return condition->kind == experiment::WorldKind::generated; }
};

std::vector<Column> columns_of(std::span<const ConditionTrials> conditions) {
  std::vector<Column> columns;
  for (const ConditionTrials& condition : conditions) {
    auto column = std::ranges::find_if(
        columns, [&](const Column& other) { return other.condition->world() == condition.world(); });
    if (column == columns.end()) column = columns.insert(column, Column{&condition, {}});
    column->views.push_back(statistics_view(condition));
  }
  return columns;
}

std::optional<double> gain_of(const json* row) {
  if (row == nullptr || row->at("gain").is_null()) return std::nullopt;
  return row->at("gain").at("mean").get<double>();
}

TextTable::Cell gain_cell(const json* row, bool best) {
  const auto gain = gain_of(row);
  if (!gain) return "-";
  const json& ci = row->at("gain").at("ci95");
  std::string text = fmt::format("{:+.2f}", *gain);
  if (!ci.is_null()) text += fmt::format(" ± {:.2f}", (ci[1].get<double>() - ci[0].get<double>()) / 2.0);
  return {text, best};
}

std::string interval_cell(const json& ci, const char* format) {
  return ci.is_null() ? "-" : fmt::format(fmt::runtime(format), ci[0].get<double>(), ci[1].get<double>());
}

std::string number_or_dash(const json& value, int decimals) {
  return value.is_null() ? "-" : fmt::format("{:.{}f}", value.get<double>(), decimals);
}

std::vector<flight::Metric> overview_metrics() {
  std::vector<flight::Metric> chosen;
  for (const flight::Metric& metric : flight::other_metrics())
    if (metric.overview_decimals) chosen.push_back(metric);
  return chosen;
}

/// Mean of one number over the generated conditions; none if any lacks it.
std::optional<double> mean_over(const std::vector<Column>& columns, const std::string& agent,
                                const json::json_pointer& key) {
  double sum = 0.0;
  double count = 0.0;
  for (const Column& column : columns) {
    if (!column.generated()) continue;
    const json* row = column.row(agent);
    if (row == nullptr || row->at(key).is_null()) return std::nullopt;
    sum += row->at(key).get<double>();
    ++count;
  }
  return count > 0.0 ? std::optional(sum / count) : std::nullopt;
}

/// The agent without privilege that gains most; none if one of them has fewer than two trials.
std::string winner(const Column& column, const std::vector<const AgentTrials*>& agents) {
  std::string best;
  double most = 0.0;
  for (const AgentTrials* agent : agents) {
    if (agent->privilege != agents::Privilege::none) continue;
    const json* row = column.row(agent->name);
    const auto gain = gain_of(row);
    if (!gain) continue;
    if (row->at("gain").at("pairs").get<std::size_t>() < 2) return "";
    if (*gain <= most) continue;
    most = *gain;
    best = agent->name;
  }
  return best;
}

}  // namespace

TextTable tournament_overview(std::span<const ConditionTrials> conditions, const StepCosts& costs) {
  const std::vector<Column> columns = columns_of(conditions);
  const std::vector<const AgentTrials*> agents = agents_of(conditions);
  std::vector<std::string> best;
  std::vector<TextTable::Column> headings{{"agent"}};
  for (const Column& column : columns) {
    best.push_back(winner(column, agents));
    headings.push_back({heading(*column.condition)});
  }
  headings.push_back({"head-room closed", 1});
  for (const flight::Metric& metric : overview_metrics()) headings.push_back({heading_of(metric), 1});
  headings.push_back({"µs per step", 1});
  TextTable table(std::move(headings));
  for (const AgentTrials* agent : agents) {
    std::vector<TextTable::Cell> row{agents::marked(agent->name, agents::privilege_tier(agent->privilege))};
    for (std::size_t i = 0; i < columns.size(); ++i)
      row.push_back(gain_cell(columns[i].row(agent->name), best[i] == agent->name));
    const auto share = mean_over(columns, agent->name, "/headroom_share"_json_pointer);
    const auto cost = costs.find(agent->name);
    row.emplace_back(share ? fmt::format("{:.0f} %", 100.0 * *share) : "-");
    for (const flight::Metric& metric : overview_metrics()) {
      const auto mean = mean_over(columns, agent->name, "/metrics"_json_pointer / std::string(metric.name));
      row.emplace_back(mean ? fmt::format("{:.{}f}", *mean, *metric.overview_decimals) : "-");
    }
    row.emplace_back(cost == costs.end() ? "-" : fmt::format("{:.{}f}", cost->second, cost->second < 10 ? 1 : 0));
    table.add(std::move(row));
  }
  return table;
}

namespace {

/// Metrics that no agent of the view has make no column.
std::vector<flight::Metric> metrics_in(const json& view) {
  std::vector<flight::Metric> known;
  for (const flight::Metric& metric : flight::other_metrics())
    if (!metric.optional || std::ranges::any_of(view.at("agents"), [&](const json& row) {
          return !row.at("metrics").at(std::string(metric.name)).is_null();
        }))
      known.push_back(metric);
  return known;
}

}  // namespace

std::string tournament_details(std::span<const ConditionTrials> conditions) {
  std::string text;
  for (const ConditionTrials& condition : conditions) {
    const json view = statistics_view(condition);
    if (view.is_null()) continue;
    text += fmt::format(
        "### {}\n\n| agent | trials | {} | 95 % interval | gain over min-height | 95 % interval | better in | "
        "head-room closed |",
        condition.kind == experiment::WorldKind::measured ? condition.label : heading(condition) + " per km²",
        condition.qos_unit());
    std::string rule = "|---|---|---|---|---|---|---|---|";
    const std::vector<flight::Metric> shown = metrics_in(view);
    for (const flight::Metric& metric : shown) {
      text += fmt::format(" {} |", heading_of(metric));
      rule += "---|";
    }
    text += fmt::format("\n{}\n", rule);
    for (const json& row : view.at("agents")) {
      const json& gain = row.at("gain");
      const auto& tier = agents::privilege_tier(row.at("privilege").get<std::string>());
      text += fmt::format("| {} | {} | {:.2f} | {} |", agents::marked(row.at("name").get<std::string>(), tier),
                          row.at("trials").get<int>(), row.at("mean").get<double>(),
                          interval_cell(row.at("ci95"), "[{:.2f}, {:.2f}]"));
      if (gain.is_null())
        text += " - | - | - | - |";
      else
        text += fmt::format(" {:+.2f} | {} | {:.0f} % | {} |", gain.at("mean").get<double>(),
                            interval_cell(gain.at("ci95"), "[{:+.2f}, {:+.2f}]"),
                            100.0 * gain.at("probability_of_improvement").get<double>(),
                            row.at("headroom_share").is_null()
                                ? "-"
                                : fmt::format("{:.0f} %", 100.0 * row.at("headroom_share").get<double>()));
      for (const flight::Metric& metric : shown)
        text += fmt::format(" {} |",
                            number_or_dash(row.at("metrics").at(std::string(metric.name)), metric.report_decimals));
      text += '\n';
    }
    text += '\n';
  }
  return text;
}

}  // namespace aloft::report
