#include "tools/export/rows.hpp"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "common/experiment/summary.hpp"
#include "tools/export/action_name.hpp"

namespace aloft::exports {
namespace {

using Row = nlohmann::ordered_json;

/// Writes rows as they come: a CSV with a header line, or a JSON array with one object per line.
class RowWriter {
 public:
  RowWriter(RowFormat format, std::FILE* out) : json_(format == RowFormat::json), out_(out) {}

  void write(const Row& row) {
    if (json_) {
      fmt::print(out_, "{}{}", first_ ? "[\n" : ",\n", row.dump());
    } else {
      if (first_) print_line(row, [](const auto& item) { return item.key(); });
      print_line(row, [](const auto& item) { return experiment::csv_cell(item.value()); });
    }
    first_ = false;
  }

  void finish() {
    if (json_) fmt::print(out_, "{}\n]\n", first_ ? "[" : "");
  }

 private:
  template <typename Text>
  void print_line(const Row& row, Text text) {
    std::string line;
    for (const auto& item : row.items()) line += (line.empty() ? "" : ",") + text(item);
    fmt::print(out_, "{}\n", line);
  }

  bool json_;
  std::FILE* out_;
  bool first_ = true;
};

/// What flights have in common, in columns of their own: the same for flights and steps, and in the Python package.
class KeyColumns {
 public:
  explicit KeyColumns(const experiment::Experiment& experiment) : experiment_(experiment) {
    for (const experiment::Condition& condition : experiment.conditions)
      for (const auto& swept : condition.parameters.items()) swept_[swept.key()] = nullptr;
  }

  [[nodiscard]] Row row(const experiment::FlightKey& key) const {
    const experiment::Condition& condition = experiment_.conditions.at(key.condition);
    const agents::AgentSpec& agent = experiment_.agent(key.agent);
    Row row{{"condition", condition.name}};
    row.update(swept_);  // a parameter that this condition does not have stays null
    row.update(Row(condition.parameters));
    row["seed"] = experiment_.seed;
    row["trial"] = key.trial;
    row["agent"] = key.agent;
    row["agent_type"] = agent.type;
    row["privilege"] = agents::privilege_tier(agent.privilege()).name;
    row["qos_unit"] = experiment::qos_unit(condition.kind);
    return row;
  }

 private:
  const experiment::Experiment& experiment_;
  Row swept_ = Row::object();  // every parameter that some condition sweeps
};

Row exported(const flight::Metric& metric, const std::optional<double>& value) {
  if (!value) return nullptr;
  return metric.integer ? Row(static_cast<std::int64_t>(*value)) : Row(*value);
}

Row flight_row(Row row, const store::FlightSummary& flight) {
  for (std::size_t i = 0; i < flight::metrics().size(); ++i)
    row[std::string(flight::metrics()[i].key)] = exported(flight::metrics()[i], flight.metrics[i]);
  row["digest"] = flight.digest;
  return row;
}

Row step_row(Row row, const flight::FlightRecord& record, std::size_t index, const flight::Costs& costs) {
  const flight::StepRecord& step = record.steps[index];
  row["step"] = step.step;
  row["action"] = action_name(step.action);
  row["flown_by"] = record.pilots.at(step.flown_by);
  row["x_m"] = step.x_m;
  row["y_m"] = step.y_m;
  row["height_m"] = step.height_m;
  row["serving_cell"] = step.serving_cell;
  row["serving_sinr_db"] = step.serving_sinr_db;
  row["qos"] = step.qos;
  row["reward"] = step.reward;
  row["energy_j"] = record.step_energy_j(index, costs);
  const auto& thoughts = step.introspection;
  const auto optional = [&](double value) { return thoughts ? Row(value) : Row(); };
  row["epsilon"] = optional(thoughts ? thoughts->epsilon : 0.0);
  row["loss"] = optional(thoughts ? thoughts->loss : 0.0);
  row["q_down"] = optional(thoughts ? thoughts->q_values[0] : 0.0);
  row["q_hold"] = optional(thoughts ? thoughts->q_values[1] : 0.0);
  row["q_up"] = optional(thoughts ? thoughts->q_values[2] : 0.0);
  return row;
}

}  // namespace

void write_rows(const store::ResultStore& results, std::span<const store::FlightSummary> flights, Rows what,
                RowFormat format, std::FILE* out) {
  const experiment::Experiment& experiment = results.experiment();
  const KeyColumns keys(experiment);
  RowWriter rows(format, out);
  for (const store::FlightSummary& flight : flights) {
    if (what == Rows::flights) {
      rows.write(flight_row(keys.row(flight.key), flight));
      continue;
    }
    const Row key = keys.row(flight.key);
    const flight::FlightRecord record = store::decode_trace(results.trace(flight.key));
    const flight::Costs costs = experiment.costs_in(experiment.conditions.at(flight.key.condition));
    for (std::size_t i = 0; i < record.steps.size(); ++i) rows.write(step_row(key, record, i, costs));
  }
  rows.finish();
}

}  // namespace aloft::exports
