#pragma once

#include <nlohmann/json_fwd.hpp>
#include <span>
#include <string>
#include <string_view>

#include "common/base/text_layout.hpp"
#include "common/experiment/experiment.hpp"
#include "common/flight/metrics.hpp"

namespace aloft::experiment {

/// One stored flight without its steps.
struct FlightSummary {
  FlightKey key;
  flight::MetricValues metrics{};
  std::string digest{};  ///< SHA-256 of the encoded trace
};

/// The quality that is measured in worlds of this kind.
[[nodiscard]] radio::QosKind qos_kind(WorldKind kind) noexcept;
/// "bit/s/Hz" (generated) or "kbit/s" (measured).
[[nodiscard]] std::string_view qos_unit(WorldKind kind);

/// The content of summary.json, for finished and unfinished experiments: conditions and agents in the experiment's
/// order, each agent with its privilege and its number of trials; mean, 95 % bootstrap interval and quartiles of the
/// quality, the means of all other metrics, and the gain over the min-height agent on the same trials. Numbers that do
/// not exist are null (no trials; no min-height agent), and so are intervals where nothing varies (one trial; the same
/// value in all). `qos_unit` is given for every condition, and at the top if all share it, else null there. `flights`
/// are sorted by trial within each (condition, agent).
[[nodiscard]] nlohmann::ordered_json summarise(const Experiment& experiment, std::span<const FlightSummary> flights,
                                               std::string_view build);

/// A value as a CSV cell: null is empty, a text is quoted where it must be.
[[nodiscard]] std::string csv_cell(const nlohmann::ordered_json& value);

/// A summary as CSV, one line per condition and agent.
[[nodiscard]] std::string summary_csv(const nlohmann::ordered_json& summary);

/// A summary as aligned text for a terminal, throughput in Mbit/s.
[[nodiscard]] std::string summary_table(const nlohmann::ordered_json& summary, const TableShape& shape = {});

}  // namespace aloft::experiment
