#pragma once

#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <span>
#include <string>

#include "common/store/result_store.hpp"

namespace aloft::report {

/// Which flights the page opens with.
struct Choice {
  std::string condition;               ///< name or number; empty: the first one with a flight
  std::optional<std::uint32_t> trial;  ///< the flight shown of each condition; nothing: the first with the most agents
};

/// The page's data block: all that the report knows of these runs, finished or not.
/// {"version", "title", "build", "experiments": [{"name", "description", "id", "seed", "trials", "flights_stored",
///   "flights_expected", "digest"}],
///  "missing": [line...], "agents": agent_list, "metrics": [{"name", "title", "decimals", "better": "higher" | "lower"
///  | null}], "privilege_tiers": [{"name", "mark", "sees", "shape": "full" | "half" | "hollow"}], "marks_explained":
///  text, "learner": name | null, "shown_condition": index, "conditions": [{"experiment": index, "name", "label",
///  "place", "site_map", "kind", "qos_name", "qos_unit",
///                  "views": {"all": statistics_view, "selected": statistics_view | null}, "flight": flight_view |
///                  null}],
///  "published": {"source", "least_trials", "left_out": {"all": [line...], "selected": [line...]}, "rows": [{"label",
///  "agent", "quantity", "unit", "published", "plus_minus", "tolerance",
///                "views": {"all": beside_published, "selected": ...}}]},
///  "claims": {"all": [{"text", "reading", "verdict", "reason", "details"}], "selected": [...]}}
/// "selected" counts only the trials in which the learner beat constant-120, as all published trials do.
/// InputError if the choice names a condition or trial that is not there.
[[nodiscard]] nlohmann::json report_data(std::span<const store::ResultStore> runs, const Choice& choice);

}  // namespace aloft::report
