#pragma once

#include <map>
#include <nlohmann/json_fwd.hpp>
#include <string>

#include "services/http/http_server.hpp"

namespace aloft::live {

/// The routes of the page itself. InputError if the program was built without it.
[[nodiscard]] std::map<std::string, http::HttpRoute> page_routes();

/// What a page without stored flights starts with: as Replay::overview(), without conditions.
[[nodiscard]] nlohmann::json empty_overview(const std::string& title);

/// The answer of a data route: JSON in ASCII, whatever the names in it are.
[[nodiscard]] http::HttpResponse json_answer(const nlohmann::json& data);

/// A number of the query, e.g. "trial". InputError if it is missing or none.
[[nodiscard]] std::uint32_t number_of(const http::HttpRequest& request, const std::string& name);

}  // namespace aloft::live
