#include <fmt/format.h>

#include <algorithm>
#include <array>
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

/// A number in `unit`, three or four digits that matter.
std::string digits(const OrderedJson& value, double unit) {
  return value.is_null() ? "-" : fmt::format("{:.2f}", value.get<double>() / unit);
}

std::string interval(const OrderedJson& value, double unit) {
  return value.is_null() ? "-" : fmt::format("[{}, {}]", digits(value[0], unit), digits(value[1], unit));
}

std::string one_decimal(const OrderedJson& value) {
  return value.is_null() ? "-" : fmt::format("{:.1f}", value.get<double>());
}

std::string gain(const OrderedJson& agent, double unit) {
  const OrderedJson& mean = agent["gain_over_min_height_mean"];
  if (mean.is_null()) return "-";
  const OrderedJson& ci95 = agent["gain_over_min_height_ci95"];
  return fmt::format("{:+.2f}{}", mean.get<double>() / unit, ci95.is_null() ? "" : " " + interval(ci95, unit));
}

/// Of one flight there are none.
std::string quartiles(const OrderedJson& agent, double unit) {
  if (agent["trials"] < 2) return "-";
  return interval(OrderedJson::array({agent["qos_q25"], agent["qos_q75"]}), unit);
}

std::vector<TextTable::Cell> table_row(const std::string& name, const OrderedJson& agent, double unit) {
  return {agents::marked(name, agents::privilege_tier(agent["privilege"].get<std::string>())),
          agent["trials"].dump(),
          digits(agent["qos_mean"], unit),
          interval(agent["qos_ci95"], unit),
          digits(agent["qos_median"], unit),
          quartiles(agent, unit),
          one_decimal(agent["height_mean_m"]),
          one_decimal(agent["height_changes_mean"]),
          one_decimal(agent["handovers_mean"]),
          digits(agent["energy_mean_j"], 1000.0),
          gain(agent, unit)};
}

TextTable condition_table(const OrderedJson& condition) {
  const bool throughput = condition.at("qos_unit") == "kbit/s";
  TextTable table({{"agent"},
                   {"trials", 5},
                   {throughput ? "Mbit/s" : "bit/s/Hz"},
                   {"[95 %]", 1},
                   {"median", 7},
                   {"[quartiles]", 8},
                   {"height m", 2},
                   {"changes", 6},
                   {"handovers", 3},
                   {"kJ", 4},
                   {"gain over min-height"}});
  for (const auto& [name, agent] : condition.at("agents").items())
    table.add(table_row(name, agent, throughput ? 1000.0 : 1.0));
  return table;
}

template <typename Predicate>
bool has_agent(const OrderedJson& summary, Predicate predicate) {
  for (const OrderedJson& condition : summary.at("conditions"))
    for (const OrderedJson& agent : condition.at("agents"))
      if (predicate(agent)) return true;
  return false;
}

}  // namespace

std::string summary_csv(const OrderedJson& summary) {
  static constexpr std::array numbers{"trials",
                                      "qos_mean",
                                      "qos_ci95",
                                      "qos_median",
                                      "qos_q25",
                                      "qos_q75",
                                      "height_mean_m",
                                      "height_changes_mean",
                                      "handovers_mean",
                                      "energy_mean_j",
                                      "gain_over_min_height_mean",
                                      "gain_over_min_height_ci95"};
  std::string text = "condition,agent,privilege,qos_unit";
  for (const std::string_view key : numbers)
    text += key.ends_with("ci95") ? fmt::format(",{0}_low,{0}_high", key) : fmt::format(",{}", key);
  text += '\n';
  for (const OrderedJson& condition : summary.at("conditions"))
    for (const auto& [name, agent] : condition.at("agents").items()) {
      text += fmt::format("{},{},{},{}", csv_cell(condition.at("name")), name, csv_cell(agent.at("privilege")),
                          csv_cell(condition.at("qos_unit")));
      for (const std::string_view key : numbers) {
        const OrderedJson& value = agent.at(std::string(key));
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
  std::vector<TextTable> tables;
  unsigned rank = TextTable::every_rank;  // the same columns in all conditions
  for (const OrderedJson& condition : summary.at("conditions")) {
    tables.push_back(condition_table(condition));
    rank = std::min(rank, tables.back().fitting_rank(shape));
  }
  for (std::size_t i = 0; i < tables.size(); ++i)
    text += '\n' + line(summary.at("conditions")[i].at("name").get<std::string>()) + tables[i].text(shape, rank);
  const std::string left_out = tables.empty() ? "" : tables.front().left_out(rank, shape);
  return left_out.empty() ? text : text + '\n' + left_out;
}

}  // namespace aloft::experiment
