#pragma once

#include <filesystem>
#include <map>
#include <nlohmann/json_fwd.hpp>
#include <string>

#include "common/store/result_store.hpp"
#include "services/http/http_server.hpp"

namespace aloft::live {

/// The flights of a result folder, for the page. Another process may be writing into the folder.
class Replay {
 public:
  /// InputError if there are no results.
  explicit Replay(const std::filesystem::path& dir);

  /// {"title", "description", "source", "agents": report::agent_list, "privilege_tiers", "marks_explained",
  ///  "conditions": [{"label", "qos_name", "qos_unit", "trials": [that have a flight, ascending]}]}
  [[nodiscard]] nlohmann::json overview() const;
  /// report::flight_view with every quantity. InputError if there is no such flight.
  [[nodiscard]] nlohmann::json flight(std::uint32_t condition, std::uint32_t trial) const;
  /// {"flights_stored", "flights_expected", "conditions": [null | {"agents": [of report::statistics_view]}]}
  [[nodiscard]] nlohmann::json results() const;

  /// The routes that answer these. The replay must outlive their server, which asks from one thread.
  [[nodiscard]] std::map<std::string, http::HttpRoute> routes() const;

 private:
  store::ResultStore store_;
  std::string source_;
};

}  // namespace aloft::live
