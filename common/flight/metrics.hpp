#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "common/flight/flight.hpp"

namespace aloft::flight {

/// The units in which a quantity is stored and shown.
struct Unit {
  std::string_view stored{};      ///< in the database, in CSV and JSON: "J"; empty: a plain number
  std::string_view shown{};       ///< in tables and charts: "kJ"
  double stored_per_shown = 1.0;  ///< stored value = shown value * this
};

enum class Better : std::uint8_t { neither, higher, lower };

/// A number that is computed for every flight.
struct Metric {
  std::string_view key;          ///< of one flight, in database, exports and reports; it has the unit in it
  std::string_view mean_key;     ///< of its mean over trials, in summary.json and summary.csv
  std::string_view name;         ///< "height changes"
  std::string_view heading;      ///< over a narrow column: "changes"
  std::string_view description;  ///< a sentence for the reference of the database
  /// The metric in its stored unit, finite; nothing: unknown. The record has at least one step.
  std::optional<double> (*value)(const FlightRecord&, const Costs&);
  Unit unit{};
  std::optional<Unit> throughput_unit{};  ///< its unit in worlds whose quality is a throughput, if different
  Better better = Better::neither;
  bool integer = false;
  bool optional = false;  ///< may be unknown
  int decimals = 1;       ///< of the shown value in the tables of a run
  int report_decimals = 1;
  std::optional<int> overview_decimals{};  ///< if set, the overview of a tournament has a column for it
  unsigned table_rank = 9;                 ///< see TextTable::Column::rank
  /// Aloft 0.2.0 reads databases of format 3 by position: the metric's column there. Unset for later metrics.
  std::optional<int> format_3_place{};

  [[nodiscard]] const Unit& unit_in(radio::QosKind kind) const noexcept;
};

/// All metrics, in the order of their columns. The first one is the quality of the link, by which agents are compared.
/// A row here, and its test, are all that a new metric takes: database, summaries, exports, tables, reports and their
/// reference are made from this table.
[[nodiscard]] std::span<const Metric> metrics();
/// The index of the quality in that table.
inline constexpr std::size_t quality = 0;
/// All metrics but the quality.
[[nodiscard]] inline std::span<const Metric> other_metrics() {
  return metrics().subspan(quality + 1);
}
/// The index of the metric with this key; std::logic_error if there is none.
[[nodiscard]] std::size_t metric_index(std::string_view key);

/// The values of one flight, in the order of the table; nothing: unknown.
class MetricValues {
 public:
  MetricValues() : values_(metrics().size()) {}

  [[nodiscard]] std::optional<double>& operator[](std::size_t index) { return values_.at(index); }
  [[nodiscard]] const std::optional<double>& operator[](std::size_t index) const { return values_.at(index); }
  [[nodiscard]] const std::optional<double>& operator[](std::string_view key) const {
    return values_.at(metric_index(key));
  }
  /// In the stored unit; NaN: unknown.
  [[nodiscard]] double number(std::size_t index) const;

 private:
  std::vector<std::optional<double>> values_;
};

/// Throws IntegrityError if the flight has no steps, or if a metric that is always known is not a finite number.
[[nodiscard]] MetricValues measure(const FlightRecord& record, const Costs& costs);

namespace testing {
/// The table itself, for tests that add a row.
[[nodiscard]] std::vector<Metric>& metric_table();
}  // namespace testing

}  // namespace aloft::flight
