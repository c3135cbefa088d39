#pragma once

#include <functional>
#include <map>
#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <string>

#include "common/experiment/experiment.hpp"
#include "services/http/http_server.hpp"

namespace aloft::live {

/// The routes of the page itself. InputError if the program was built without it.
[[nodiscard]] std::map<std::string, http::HttpRoute> page_routes();

/// What the page starts with, without flights: {"title", "description", "source", "agents": report::agent_list,
/// "privilege_tiers", "marks_explained", "conditions": [{"label", "qos_name", "qos_unit", "trials": []}]}
[[nodiscard]] nlohmann::json overview_of(const experiment::Experiment& experiment);
/// The same if the experiment is not known yet: no agents and no conditions.
[[nodiscard]] nlohmann::json empty_overview(const std::string& title);

/// "/data/world" answers report::world_view for ?condition=NUMBER&trial=NUMBER. `experiment`: null if it is not known.
using KnownExperiment = std::function<std::shared_ptr<const experiment::Experiment>()>;
[[nodiscard]] std::map<std::string, http::HttpRoute> world_routes(const KnownExperiment& experiment);

/// The answer of a data route: JSON in ASCII, whatever the names in it are.
[[nodiscard]] http::HttpResponse json_answer(const nlohmann::json& data);

/// A number of the query, e.g. "trial". InputError if it is missing or none.
[[nodiscard]] std::uint32_t number_of(const http::HttpRequest& request, const std::string& name);

}  // namespace aloft::live
