#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <vector>

#include "common/base/text_layout.hpp"
#include "common/experiment/summary.hpp"

namespace aloft::experiment {

using OrderedJson = nlohmann::ordered_json;

std::string csv_cell(const OrderedJson& value) {
  if (value.is_null()) return "";
  if (!value.is_string()) return value.dump();
  auto text = value.get<std::string>();
  if (text.find_first_of(",\"\n") == std::string::npos) return text;
  std::string quoted = "\"";
  for (const char c : text) quoted += c == '"' ? "\"\"" : std::string(1, c);
  return quoted + '"';
}

namespace {

/// A number in `unit` with two decimals; "-" if there is none.
std::string digits(const OrderedJson& value, double unit) {
  return value.is_null() ? "-" : fmt::format("{:.2f}", value.get<double>() / unit);
}

std::string interval(const OrderedJson& value, double unit) {
  return value.is_null() ? "-" : fmt::format("[{}, {}]", digits(value[0], unit), digits(value[1], unit));
}

std::string mean_of(const flight::Metric& metric, const OrderedJson& agent, radio::QosKind kind) {
  const OrderedJson& value = agent[metric.mean_key];
  return value.is_null()
             ? "-"
             : fmt::format("{:.{}f}", value.get<double>() / metric.unit_in(kind).stored_per_shown, metric.decimals);
}

std::string gain(const OrderedJson& agent, double unit) {
  const OrderedJson& mean = agent["gain_over_min_height_mean"];
  if (mean.is_null()) return "-";
  const OrderedJson& ci95 = agent["gain_over_min_height_ci95"];
  return fmt::format("{:+.2f}{}", mean.get<double>() / unit, ci95.is_null() ? "" : " " + interval(ci95, unit));
}

/// One flight has no quartiles.
std::string quartiles(const OrderedJson& agent, double unit) {
  if (agent["trials"] < 2) return "-";
  return interval(OrderedJson::array({agent["qos_q25"], agent["qos_q75"]}), unit);
}

using MetricList = std::vector<flight::Metric>;

std::vector<TextTable::Cell> table_row(const std::string& name, const OrderedJson& agent, radio::QosKind kind,
                                       const MetricList& shown) {
  const double unit = flight::metrics()[flight::quality].unit_in(kind).stored_per_shown;
  std::vector<TextTable::Cell> row{agents::marked(name, agents::privilege_tier(agent["privilege"].get<std::string>())),
                                   agent["trials"].dump(),
                                   digits(agent["qos_mean"], unit),
                                   interval(agent["qos_ci95"], unit),
                                   digits(agent["qos_median"], unit),
                                   quartiles(agent, unit)};
  for (const flight::Metric& metric : shown) row.emplace_back(mean_of(metric, agent, kind));
  row.emplace_back(gain(agent, unit));
  return row;
}

TextTable condition_table(const OrderedJson& condition, const MetricList& shown) {
  const radio::QosKind kind = condition.at("qos_unit") == qos_unit(WorldKind::measured)
                                  ? radio::QosKind::throughput
                                  : radio::QosKind::spectral_efficiency;
  std::vector<TextTable::Column> columns{
      {"agent"},     {"trials", 5}, {std::string(flight::metrics()[flight::quality].unit_in(kind).shown)},
      {"[95 %]", 1}, {"median", 7}, {"[quartiles]", 8}};
  for (const flight::Metric& metric : shown) columns.push_back({std::string(metric.heading), metric.table_rank});
  columns.push_back({"gain over min-height"});
  TextTable table(std::move(columns));
  for (const auto& [name, agent] : condition.at("agents").items()) table.add(table_row(name, agent, kind, shown));
  return table;
}

template <typename Predicate>
bool has_agent(const OrderedJson& summary, Predicate predicate) {
  for (const OrderedJson& condition : summary.at("conditions"))
    for (const OrderedJson& agent : condition.at("agents"))
      if (predicate(agent)) return true;
  return false;
}

/// Metrics that no flight has make no column.
MetricList shown_metrics(const OrderedJson& summary) {
  MetricList shown;
  for (const flight::Metric& metric : flight::other_metrics())
    if (!metric.optional ||
        has_agent(summary, [&](const OrderedJson& agent) { return !agent.at(metric.mean_key).is_null(); }))
      shown.push_back(metric);
  return shown;
}

}  // namespace

std::string summary_csv(const OrderedJson& summary) {
  std::vector<std::string> numbers;  // all agents have the same keys
  for (const auto& [key, value] : summary.at("conditions").at(0).at("agents").front().items())
    if (key != "privilege") numbers.push_back(key);
  std::string text = "condition,agent,privilege,qos_unit";
  for (const std::string& key : numbers)
    text += key.ends_with("ci95") ? fmt::format(",{0}_low,{0}_high", key) : fmt::format(",{}", key);
  text += '\n';
  for (const OrderedJson& condition : summary.at("conditions"))
    for (const auto& [name, agent] : condition.at("agents").items()) {
      text += fmt::format("{},{},{},{}", csv_cell(condition.at("name")), name, csv_cell(agent.at("privilege")),
                          csv_cell(condition.at("qos_unit")));
      for (const std::string& key : numbers) {
        const OrderedJson& value = agent.at(key);
        if (!key.ends_with("ci95"))
          text += ',' + csv_cell(value);
        else
          text += value.is_null() ? ",," : fmt::format(",{},{}", csv_cell(value[0]), csv_cell(value[1]));
      }
      text += '\n';
    }
  return text;
}

std::string summary_table(const OrderedJson& summary, const TableShape& shape) {
  const auto line = [&](const std::string& text) { return wrapped(text, shape.width); };
  std::string text = line(fmt::format("{} (seed {}): mean over the flight, then over trials; [95 % interval]",
                                      summary.at("experiment").get<std::string>(), summary.at("seed").dump()));
  if (has_agent(summary, [](const OrderedJson& agent) { return agent["privilege"] != "none"; }))
    text += line(fmt::format("Privileged: {}.", agents::marks_explained()));
  if (has_agent(summary, [](const OrderedJson& agent) { return agent["trials"] > 0 && agent["qos_ci95"].is_null(); }))
    text += line("No interval: there is one flight, or all flights gave the same.");
  const MetricList shown = shown_metrics(summary);
  std::vector<TextTable> tables;
  unsigned rank = TextTable::every_rank;  // the same columns in all conditions
  for (const OrderedJson& condition : summary.at("conditions")) {
    tables.push_back(condition_table(condition, shown));
    rank = std::min(rank, tables.back().fitting_rank(shape));
  }
  for (std::size_t i = 0; i < tables.size(); ++i)
    text += '\n' + line(summary.at("conditions")[i].at("name").get<std::string>()) + tables[i].text(shape, rank);
  const std::string left_out = tables.empty() ? "" : tables.front().left_out(rank, shape);
  return left_out.empty() ? text : text + '\n' + left_out;
}

}  // namespace aloft::experiment
