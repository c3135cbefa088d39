#include "tools/report/latex.hpp"

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

using namespace aloft::report;
using nlohmann::json;

namespace {

const json data = json::parse(R"json({
  "build": "aloft test",
  "experiments": [{"name": "a_b"}],
  "metrics": [{"name": "energy", "title": "Energy (kJ)", "decimals": 1}],
  "privilege_tiers": [{"name": "none", "mark": "", "knows": "own reports"}, {"name": "all", "mark": "**", "knows": "foresight"}],
  "marks_explained": "** sees all",
  "conditions": [
    {"experiment": 0, "label": "10 % missing, 1 BS per km²", "qos_name": "Quality", "qos_unit": "bit/s/Hz", "views": {"all": {"agents": [
      {"name": "min-height", "privilege": "none", "trials": 2, "mean": 1.0, "ci95": null, "gain": {"mean": 0.0, "ci95": null}, "metrics": {"energy": null}},
      {"name": "planner", "privilege": "all", "trials": 2, "mean": 2.346, "ci95": [2.0, 2.5], "gain": {"mean": -0.5, "ci95": [-1.0, 0.25]},
       "metrics": {"energy": 12.34}}]}}},
    {"views": {"all": null}}]})json");

}  // namespace

TEST_CASE("what LaTeX takes for commands is escaped", "[report]") {
  CHECK(latex_text("a_b 5 % & #1 $x {y} ~^ km²") ==
        "a\\_b 5 \\% \\& \\#1 \\$x \\{y\\} \\textasciitilde{}\\textasciicircum{} km\\textsuperscript{2}");
  CHECK(latex_text("\\input") == "\\textbackslash{}input");
}

TEST_CASE("a table of LaTeX has means, intervals and what agents know", "[report]") {
  const std::string tables = latex_tables(data);
  CHECK_THAT(tables, Catch::Contains("    min-height & own reports & 2 & $1.00$ & -- & -- & -- & -- \\\\\n"));
  CHECK_THAT(tables, Catch::Contains("    planner ** & foresight & 2 & $2.35$ & [$2.00$, $2.50$] & $-0.50$ & [$-1.00$, "
                                     "$+0.25$] & $12.3$ \\\\\n"));
  CHECK_THAT(tables, Catch::Contains("\\caption{a\\_b: 10 \\% missing, 1 BS per km\\textsuperscript{2}. Quality"));
  CHECK_THAT(tables,
             Catch::Contains("\\begin{tabular}{llrrlrlr}\n    \\toprule\n") && Catch::Contains("\\bottomrule\n"));
}
