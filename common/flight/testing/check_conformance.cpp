#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include "common/flight/testing/conformance.hpp"

namespace aloft::flight {

void check_conformance(const nlohmann::json& entry, const ConformanceOptions& options) {
  const std::vector<std::string> problems = conformance_problems(entry, options);
  for (const std::string& problem : problems) FAIL_CHECK(problem);
  CHECK(problems.empty());
}

}  // namespace aloft::flight
