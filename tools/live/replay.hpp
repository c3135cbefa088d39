#pragma once

#include <chrono>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <string>

#include "common/store/result_store.hpp"
#include "services/http/http_server.hpp"

namespace aloft::live {

/// The flights of a result folder, for the page. Another process may be writing into the folder.
class Replay {
 public:
  /// InputError if there are no results.
  explicit Replay(const std::filesystem::path& dir);

  /// overview_of() the experiment; the trials are those that have a flight, ascending.
  [[nodiscard]] nlohmann::json overview() const;
  /// report::flight_view with every quantity. InputError if there is no such flight.
  [[nodiscard]] nlohmann::json flight(std::uint32_t condition, std::uint32_t trial) const;
  /// {"flights_stored", "flights_expected", "conditions": [null | {"agents": [of report::statistics_view]}]}
  /// While flights arrive it is computed now and then: the longer it takes, the more seldom.
  [[nodiscard]] const nlohmann::json& results();

  /// The experiment of these results; it stays valid with the replay.
  [[nodiscard]] const experiment::Experiment& experiment() const noexcept { return store_.experiment(); }

  /// The routes that answer these, results() as events, too. The replay must outlive their server, which asks from one
  /// thread.
  [[nodiscard]] std::map<std::string, http::HttpRoute> routes();

 private:
  using Clock = std::chrono::steady_clock;
  [[nodiscard]] nlohmann::json computed_results(std::size_t stored) const;

  store::ResultStore store_;
  std::string source_;
  nlohmann::json results_;
  Clock::time_point results_due_;
};

}  // namespace aloft::live
