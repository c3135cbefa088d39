#include "common/flight/metrics.hpp"

#include <fmt/format.h>

#include <cmath>
#include <iterator>
#include <limits>
#include <stdexcept>

#include "common/base/error.hpp"

namespace aloft::flight {

namespace {

constexpr Metric rows[] = {
    {.key = "qos_mean",
     .mean_key = "qos_mean",
     .name = "quality",
     .heading = "quality",
     .description = "Mean quality over the steps: bit/s/Hz in generated worlds, kbit/s in measured ones.",
     .value = [](const FlightRecord& record, const Costs&) { return std::optional(record.qos_mean()); },
     .unit = {"bit/s/Hz", "bit/s/Hz"},
     .throughput_unit = Unit{"kbit/s", "Mbit/s", 1000.0},
     .better = Better::higher,
     .decimals = 2,
     .report_decimals = 2,
     .table_rank = 0,
     .format_3_place = 0},
    {.key = "height_mean_m",
     .mean_key = "height_mean_m",
     .name = "mean height",
     .heading = "height m",
     .description = "Mean height over the steps.",
     .value = [](const FlightRecord& record, const Costs&) { return std::optional(record.height_mean_m()); },
     .unit = {"m", "m"},
     .table_rank = 2,
     .format_3_place = 1},
    {.key = "height_changes",
     .mean_key = "height_changes_mean",
     .name = "height changes",
     .heading = "changes",
     .description = "Steps in which the height changed.",
     .value = [](const FlightRecord& record, const Costs&) { return std::optional<double>(record.height_changes()); },
     .better = Better::lower,
     .integer = true,
     .overview_decimals = 0,
     .table_rank = 6,
     .format_3_place = 2},
    {.key = "handovers",
     .mean_key = "handovers_mean",
     .name = "handovers",
     .heading = "handovers",
     .description = "Changes of the serving cell, with serving `a3` those by handover; NULL: the cells are unknown.",
     .value = [](const FlightRecord& record, const Costs& costs) -> std::optional<double> {
       if (costs.a3) return record.mobility().handovers;
       return record.handovers();
     },
     .better = Better::lower,
     .integer = true,
     .optional = true,
     .table_rank = 3,
     .format_3_place = 4},
    {.key = "energy_j",
     .mean_key = "energy_mean_j",
     .name = "energy",
     .heading = "kJ",
     .description = "Energy of the flight; docs/experiments.md tells how it is counted.",
     .value = [](const FlightRecord& record, const Costs& costs) { return std::optional(record.energy_j(costs)); },
     .unit = {"J", "kJ", 1000.0},
     .better = Better::lower,
     .decimals = 2,
     .overview_decimals = 1,
     .table_rank = 4,
     .format_3_place = 3},
    {.key = "ping_pongs",
     .mean_key = "ping_pongs_mean",
     .name = "ping-pongs",
     .heading = "ping-pongs",
     .description = "Handovers back to the former cell within `minimum_stay_s`; NULL: serving is not `a3`.",
     .value = [](const FlightRecord& record, const Costs& costs) -> std::optional<double> {
       if (!costs.a3) return std::nullopt;
       return record.mobility().ping_pongs;
     },
     .better = Better::lower,
     .integer = true,
     .optional = true},
    {.key = "radio_link_failures",
     .mean_key = "radio_link_failures_mean",
     .name = "radio link failures",
     .heading = "RLF",
     .description = "Links and handovers that failed; NULL: serving is not `a3`.",
     .value = [](const FlightRecord& record, const Costs& costs) -> std::optional<double> {
       if (!costs.a3) return std::nullopt;
       return record.mobility().radio_link_failures;
     },
     .better = Better::lower,
     .integer = true,
     .optional = true},
    {.key = "outage_s",
     .mean_key = "outage_mean_s",
     .name = "outage",
     .heading = "outage s",
     .description = "Time with an SINR below `outage_threshold_db`, and without a cell.",
     .value = [](const FlightRecord& record, const Costs& costs) { return std::optional(record.outage_s(costs)); },
     .unit = {"s", "s"},
     .better = Better::lower},
};

}  // namespace

std::vector<Metric>& testing::metric_table() {
  static std::vector<Metric> table(std::begin(rows), std::end(rows));
  return table;
}

const Unit& Metric::unit_in(radio::QosKind kind) const noexcept {
  return kind == radio::QosKind::throughput && throughput_unit ? *throughput_unit : unit;
}

std::span<const Metric> metrics() {
  return testing::metric_table();
}

std::size_t metric_index(std::string_view key) {
  for (std::size_t i = 0; i < metrics().size(); ++i)
    if (metrics()[i].key == key) return i;
  throw std::logic_error(fmt::format("there is no metric '{}'", key));
}

double MetricValues::number(std::size_t index) const {
  return values_.at(index).value_or(std::numeric_limits<double>::quiet_NaN());
}

MetricValues measure(const FlightRecord& record, const Costs& costs) {
  if (record.steps.empty()) throw IntegrityError("a flight without steps is no result");
  MetricValues values;
  for (std::size_t i = 0; i < metrics().size(); ++i) {
    const Metric& metric = metrics()[i];
    values[i] = metric.value(record, costs);
    if (values[i] ? !std::isfinite(*values[i]) : !metric.optional)
      throw IntegrityError("the {} of a flight is not a finite number", metric.name);
  }
  return values;
}

}  // namespace aloft::flight
