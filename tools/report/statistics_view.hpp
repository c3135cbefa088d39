#pragma once

#include <nlohmann/json_fwd.hpp>

#include "tools/report/trials.hpp"

namespace aloft::report {

/// Everything the page shows over the trials of one condition; null if no flight is stored:
/// {"trials", "profile_thresholds": [q...], "agents": [{"name", "privilege", "trials", "mean", "ci95": [lo, hi],
/// "median", "q25", "q75", "whiskers": [lo, hi], "outliers": [...], "iqm", "iqm_ci95", "height_ci95_m", "metrics":
/// {name: mean in the unit that people read; null: unknown}, "headroom_share" (0: min-height, 1: the planner; null
/// without them), "profile": [share of trials above each threshold...], "heights": {"height_m": [...], "share": [of
/// all steps...]}, "gain": null |
/// {"pairs", "mean", "ci95", "probability_of_improvement"}}]}, gain over min-height on the same worlds. The intervals
/// are seeded like those of summary.json, and equal to them; null where nothing varies, as with one trial.
[[nodiscard]] nlohmann::json statistics_view(const ConditionTrials& condition);

/// The value with four decimals at most: the page shows no more, and the file stays small. Null if it is not finite.
[[nodiscard]] nlohmann::json rounded(double value);
/// The value with four significant digits, for quantities that span magnitudes.
[[nodiscard]] nlohmann::json significant(double value);

}  // namespace aloft::report
