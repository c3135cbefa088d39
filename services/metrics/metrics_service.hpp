#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "services/runtime/service.hpp"

namespace aloft::metrics {

struct ServiceOptions {
  std::filesystem::path experiment;  ///< canonical JSON
  std::filesystem::path results;     ///< folder of results.sqlite
  std::optional<int> http_port;      ///< 0: any free one; none: no HTTP
  std::string http_address = "127.0.0.1";
  std::vector<std::string> http_hosts;  ///< further names under which HTTP requests may come
  bool summary = false;  ///< write summary.json and summary.csv at the end of the run; go on when a coordinator stops
};

/// Stores what the channels report until the run ends or a stop is requested. InputError if the experiment, the results
/// or the port cannot be used, and then leaves no new files; IntegrityError if a flight comes with two
/// different traces; store::ResultsGone if the results are deleted, moved or replaced meanwhile.
void collect(runtime::Service& service, const ServiceOptions& options);

}  // namespace aloft::metrics
