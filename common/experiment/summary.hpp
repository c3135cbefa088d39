#pragma once

#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "common/base/text_layout.hpp"
#include "common/experiment/experiment.hpp"

namespace aloft::experiment {

/// What one flight contributes to a summary.
struct FlightScore {
  FlightKey key;
  double qos_mean = 0.0;  ///< bit/s/Hz or kbit/s
  double height_mean_m = 0.0;
  std::uint32_t height_changes = 0;
  double energy_j = 0.0;
  std::optional<std::uint32_t> handovers{};  ///< none: unknown
};

/// "bit/s/Hz" (generated) or "kbit/s" (measured).
[[nodiscard]] std::string_view qos_unit(WorldKind kind) noexcept;

/// The content of summary.json, for finished and unfinished experiments: conditions and agents in the experiment's
/// order, each agent with its privilege and its number of trials; means, 95 % bootstrap intervals, quartiles, and the
/// gain over the min-height agent on the same trials. Numbers that do not exist are null (no trials; no min-height
/// agent), and so are intervals where nothing varies (one trial; the same value in all). `qos_unit` stands at every
/// condition, and at the top if all share it, else null there. `scores` are sorted by trial within each (condition,
/// agent).
[[nodiscard]] nlohmann::ordered_json summarise(const Experiment& experiment, std::span<const FlightScore> scores,
                                               std::string_view build);

/// A value as a CSV cell: null is empty, a text is quoted where it must be.
[[nodiscard]] std::string csv_cell(const nlohmann::ordered_json& value);

/// A summary as CSV, one line per condition and agent.
[[nodiscard]] std::string summary_csv(const nlohmann::ordered_json& summary);

/// A summary as aligned text for a terminal, throughput in Mbit/s.
[[nodiscard]] std::string summary_table(const nlohmann::ordered_json& summary, const TableShape& shape = {});

}  // namespace aloft::experiment
