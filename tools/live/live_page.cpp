#include "tools/live/live_page.hpp"

#include <nlohmann/json.hpp>

#include "common/base/build_info.hpp"
#include "common/base/error.hpp"
#include "common/base/number_text.hpp"
#include "tools/live/embedded.hpp"

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

nlohmann::json empty_overview(const std::string& title) {
  const nlohmann::json none = nlohmann::json::array();
  return {{"title", title},    {"description", ""},       {"source", "aloft " + std::string(build_id())},
          {"agents", none},    {"privilege_tiers", none}, {"marks_explained", ""},
          {"conditions", none}};
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
