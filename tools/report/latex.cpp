#include "tools/report/latex.hpp"

#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <utility>
#include <vector>

namespace aloft::report {
namespace {

using nlohmann::json;

std::string number(const json& value, int decimals, bool with_sign = false) {
  if (value.is_null()) return "--";
  return with_sign ? fmt::format("${:+.{}f}$", value.get<double>(), decimals)
                   : fmt::format("${:.{}f}$", value.get<double>(), decimals);
}

std::string interval(const json& pair, bool with_sign = false) {
  if (pair.is_null()) return "--";
  return fmt::format("[{}, {}]", number(pair[0], 2, with_sign), number(pair[1], 2, with_sign));
}

/// The tier of an agent, as a row of "privilege_tiers".
const json& tier_of(const json& data, const json& privilege) {
  for (const json& tier : data.at("privilege_tiers"))
    if (tier.at("name") == privilege) return tier;
  return data.at("privilege_tiers").front();
}

std::string row_of(const json& data, const json& agent) {
  const json& tier = tier_of(data, agent.at("privilege"));
  const std::string mark = tier.at("mark").get<std::string>();
  const bool has_gain = !agent.at("gain").is_null() && agent.at("name") != "min-height";
  std::string row =
      fmt::format("    {}{} & {} & {} & {} & {} & {} & {}", latex_text(agent.at("name").get<std::string>()),
                  mark.empty() ? "" : " " + latex_text(mark), latex_text(tier.at("knows").get<std::string>()),
                  agent.at("trials").get<std::size_t>(), number(agent.at("mean"), 2), interval(agent.at("ci95")),
                  has_gain ? number(agent["gain"]["mean"], 2, true) : "--",
                  has_gain ? interval(agent["gain"]["ci95"], true) : "--");
  for (const json& metric : data.at("metrics"))
    row +=
        " & " + number(agent.at("metrics").at(metric.at("name").get<std::string>()), metric.at("decimals").get<int>());
  return row + " \\\\\n";
}

std::string table_of(const json& data, const json& condition, std::size_t index) {
  const json& experiment = data.at("experiments").at(condition.at("experiment").get<std::size_t>());
  std::string headings =
      fmt::format("Agent & Knows & Trials & Mean ({}) & 95\\,\\% interval & Gain & 95\\,\\% interval",
                  latex_text(condition.at("qos_unit").get<std::string>()));
  std::string columns = "llrrlrl";
  for (const json& metric : data.at("metrics")) {
    headings += " & " + latex_text(metric.at("title").get<std::string>());
    columns += 'r';
  }
  std::string rows;
  for (const json& agent : condition.at("views").at("all").at("agents")) rows += row_of(data, agent);
  return fmt::format(
      "\\begin{{table}}\n  \\centering\n"
      "  \\caption{{{}: {}. {} ({}) and gain over min-height on the same worlds, means over trials with 95\\,\\% "
      "bootstrap "
      "intervals. {}.}}\n"
      "  \\label{{tab:aloft-{}}}\n"
      "  \\begin{{tabular}}{{{}}}\n    \\toprule\n    {} \\\\\n    \\midrule\n{}    \\bottomrule\n"
      "  \\end{{tabular}}\n\\end{{table}}\n",
      latex_text(experiment.at("name").get<std::string>()), latex_text(condition.at("label").get<std::string>()),
      latex_text(condition.at("qos_name").get<std::string>()), latex_text(condition.at("qos_unit").get<std::string>()),
      latex_text(data.at("marks_explained").get<std::string>()), index + 1, columns, headings, rows);
}

}  // namespace

std::string latex_text(std::string_view text) {
  static const std::vector<std::pair<std::string_view, std::string_view>> escapes{{"\\", "\\textbackslash{}"},
                                                                                  {"~", "\\textasciitilde{}"},
                                                                                  {"^", "\\textasciicircum{}"},
                                                                                  {"&", "\\&"},
                                                                                  {"%", "\\%"},
                                                                                  {"$", "\\$"},
                                                                                  {"#", "\\#"},
                                                                                  {"_", "\\_"},
                                                                                  {"{", "\\{"},
                                                                                  {"}", "\\}"},
                                                                                  {"²", "\\textsuperscript{2}"}};
  std::string escaped;
  while (!text.empty()) {
    std::string_view as = text.substr(0, 1);
    std::size_t length = 1;
    for (const auto& [special, written] : escapes)
      if (text.starts_with(special)) {
        as = written;
        length = special.size();
      }
    escaped += as;
    text.remove_prefix(length);
  }
  return escaped;
}

std::string latex_tables(const nlohmann::json& data) {
  std::string tables = fmt::format("% {}; read by \\input{{...}}, needs \\usepackage{{booktabs}}\n",
                                   data.at("build").get<std::string>());
  const json& conditions = data.at("conditions");
  for (std::size_t i = 0; i < conditions.size(); ++i)
    if (!conditions[i].at("views").at("all").is_null()) tables += "\n" + table_of(data, conditions[i], i);
  return tables;
}

}  // namespace aloft::report
