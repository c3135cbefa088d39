#include <fmt/format.h>

#include <array>
#include <nlohmann/json.hpp>

#include "common/experiment/summary.hpp"
#include "common/store/result_store.hpp"
#include "tools/aloft/commands.hpp"

namespace aloft::cli {
namespace {

using Row = nlohmann::ordered_json;

std::string_view action_name(agents::Action action) {
  constexpr std::array names{"none", "down", "hold", "up", "absolute"};
  return names.at(static_cast<std::size_t>(action));
}

/// Writes rows as they come: a CSV with a header line, or a JSON array with one object per line.
class RowWriter {
 public:
  explicit RowWriter(bool json) : json_(json) {}

  void write(const Row& row) {
    if (json_) {
      fmt::print("{}{}", first_ ? "[\n" : ",\n", row.dump());
    } else {
      if (first_) print_line(row, [](const auto& item) { return item.key(); });
      print_line(row, [](const auto& item) { return experiment::csv_cell(item.value()); });
    }
    first_ = false;
  }

  void finish() {
    if (json_) fmt::print("{}\n]\n", first_ ? "[" : "");
  }

 private:
  template <typename Text>
  static void print_line(const Row& row, Text text) {
    std::string line;
    for (const auto& item : row.items()) line += (line.empty() ? "" : ",") + text(item);
    fmt::print("{}\n", line);
  }

  bool json_;
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

void export_flights(const store::ResultStore& results, RowWriter& rows) {
  const KeyColumns keys(results.experiment());
  for (const store::FlightSummary& flight : results.flights()) {
    Row row = keys.row(flight.key);
    for (std::size_t i = 0; i < flight::metrics().size(); ++i)
      row[std::string(flight::metrics()[i].key)] = exported(flight::metrics()[i], flight.metrics[i]);
    row["digest"] = flight.digest;
    rows.write(row);
  }
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

void export_steps(const store::ResultStore& results, RowWriter& rows) {
  const KeyColumns keys(results.experiment());
  for (const store::FlightSummary& flight : results.flights()) {
    const Row key = keys.row(flight.key);
    const flight::FlightRecord record = store::decode_trace(results.trace(flight.key));
    const auto& experiment = results.experiment();
    const flight::Costs costs = experiment.costs_in(experiment.conditions.at(flight.key.condition));
    for (std::size_t i = 0; i < record.steps.size(); ++i) rows.write(step_row(key, record, i, costs));
  }
}

}  // namespace

void add_export(CLI::App& app, Job& job) {
  struct Options {
    std::filesystem::path dir;
    bool steps = false;
    bool flights = false;
    std::string format;
  };
  auto* command =
      app.add_subcommand("export", "Write the flights or the single steps of a result folder to standard output");
  auto options = std::make_shared<Options>();
  command->add_option("dir", options->dir, "Result folder of 'aloft run'")->required();
  auto* what = command->add_option_group("what")->require_option(1);
  what->add_flag("--flights", options->flights, "One row per flight");
  what->add_flag("--steps", options->steps, "One row per step of every flight");
  add_format(*command, options->format, {"csv", "json"});
  command->callback([options, &job] {
    job = [options] {
      const auto results = store::ResultStore::open_for_reading(options->dir);
      RowWriter rows(options->format == "json");
      options->steps ? export_steps(results, rows) : export_flights(results, rows);
      rows.finish();
      return 0;
    };
  });
}

}  // namespace aloft::cli
