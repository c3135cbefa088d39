#include "tools/live/live_page.hpp"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "common/base/build_info.hpp"
#include "common/base/error.hpp"
#include "common/base/number_text.hpp"
#include "tools/live/embedded.hpp"
#include "tools/report/agent_list.hpp"
#include "tools/report/flight_view.hpp"
#include "tools/report/trials.hpp"

namespace aloft::live {

std::map<std::string, http::HttpRoute> page_routes() {
  if (embedded_html().empty())
    throw InputError(
        "this aloft was built without its live page; in its checkout, tools/setup.sh adds it (and node, npm and "
        "esbuild, which bundle it)");
  const auto file = [](const char* type, std::string_view text) {
    return http::HttpRoute{[=](const http::HttpRequest&) {
                             return http::HttpResponse{200, type, std::string(text)};
                           },
                           true};
  };
  return {{"/", file("text/html; charset=utf-8", embedded_html())},
          {"/live.js", file("text/javascript; charset=utf-8", embedded_script())},
          {"/live.css", file("text/css; charset=utf-8", embedded_style())}};
}

nlohmann::json overview_of(const experiment::Experiment& experiment) {
  const std::vector<report::ConditionTrials> conditions = report::without_flights(experiment);
  nlohmann::json overview = empty_overview(experiment.name);
  overview["description"] = experiment.description;
  overview["source"] = fmt::format("experiment {}, seed {}; aloft {}", experiment.id, experiment.seed, build_id());
  overview["agents"] = report::agent_list(conditions);
  for (const report::ConditionTrials& condition : conditions)
    overview["conditions"].push_back({{"label", condition.label},
                                      {"qos_name", condition.qos_name()},
                                      {"qos_unit", condition.qos_unit()},
                                      {"trials", nlohmann::json::array()}});
  return overview;
}

nlohmann::json empty_overview(const std::string& title) {
  const nlohmann::json none = nlohmann::json::array();
  return {{"title", title},
          {"description", ""},
          {"source", "aloft " + std::string(build_id())},
          {"agents", none},
          {"privilege_tiers", report::tier_list()},
          {"marks_explained", agents::marks_explained()},
          {"conditions", none}};
}

std::map<std::string, http::HttpRoute> world_routes(const KnownExperiment& experiment) {
  return {{"/data/world", {[experiment](const http::HttpRequest& request) {
             const auto known = experiment();
             if (known == nullptr) throw InputError("{}: the experiment of the run is not known yet", request.path);
             const std::uint32_t condition = number_of(request, "condition");
             const std::uint32_t trial = number_of(request, "trial");
             if (condition >= known->conditions.size())
               throw InputError("there is no condition {}; allowed: 0 to {}", condition, known->conditions.size() - 1);
             if (trial >= known->trials)
               throw InputError("there is no trial {}; allowed: 0 to {}", trial, known->trials - 1);
             return json_answer(report::world_view(*known, condition, trial));
           }}}};
}

http::HttpResponse json_answer(const nlohmann::json& data) {
  return {200, "application/json", data.dump(-1, ' ', true, nlohmann::json::error_handler_t::replace) + "\n"};
}

std::uint32_t number_of(const http::HttpRequest& request, const std::string& name) {
  const auto given = request.query.find(name);
  const auto number = given == request.query.end() ? std::nullopt : number_in<std::uint32_t>(given->second);
  if (!number) throw InputError("{}: '{}' must be a whole number", request.path, name);
  return *number;
}

}  // namespace aloft::live
