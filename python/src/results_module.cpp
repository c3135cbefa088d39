// _core.Results: the flights and steps of a result folder, as columns. The global lock is held: a store is for one
// thread.
#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>
#include <nanobind/stl/filesystem.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include <limits>
#include <map>

#include "common/experiment/summary.hpp"
#include "common/flight/metrics.hpp"
#include "common/store/result_store.hpp"
#include "python/src/modules.hpp"

namespace nb = nanobind;
using namespace nb::literals;

namespace aloft::python {
namespace {

using store::ResultStore;

/// Columns by name, all of the same length. Texts are numbers that count within a list of names.
struct Columns {
  std::map<std::string, std::vector<double>> numbers;
  std::map<std::string, std::vector<std::int64_t>> integers;
};

/// Names in the order in which they were first met.
class Names {
 public:
  std::int64_t number(const std::string& name) {
    const auto [at, is_new] = numbers_.try_emplace(name, static_cast<std::int64_t>(names_.size()));
    if (is_new) names_.push_back(name);
    return at->second;
  }
  [[nodiscard]] const std::vector<std::string>& all() const noexcept { return names_; }

 private:
  std::map<std::string, std::int64_t> numbers_;
  std::vector<std::string> names_;
};

template <typename Value>
nb::object array_of(std::vector<Value>&& values) {
  auto* const kept = new std::vector<Value>(std::move(values));
  const nb::capsule owner(kept, [](void* memory) noexcept { delete static_cast<std::vector<Value>*>(memory); });
  return nb::cast(nb::ndarray<nb::numpy, Value>(kept->data(), {kept->size()}, owner));
}

nb::dict arrays_of(Columns&& columns) {
  nb::dict all;
  for (auto& [name, values] : columns.numbers) all[name.c_str()] = array_of(std::move(values));
  for (auto& [name, values] : columns.integers) all[name.c_str()] = array_of(std::move(values));
  return all;
}

void add_key(Columns& columns, const experiment::Experiment& experiment, const experiment::FlightKey& key) {
  columns.integers["condition"].push_back(key.condition);
  columns.integers["trial"].push_back(key.trial);
  columns.integers["agent"].push_back(static_cast<std::int64_t>(experiment.agent_index(key.agent)));
}

/// The columns of the flights, and their digests.
nb::tuple flights(const ResultStore& results) {
  Columns columns;
  std::vector<std::string> digests;
  results.for_each_flight([&](const store::FlightSummary& flight) {
    add_key(columns, results.experiment(), flight.key);
    for (std::size_t i = 0; i < flight::metrics().size(); ++i) {
      const flight::Metric& metric = flight::metrics()[i];
      const std::string name(metric.key);
      if (metric.integer && !metric.optional)
        columns.integers[name].push_back(static_cast<std::int64_t>(flight.metrics.number(i)));
      else
        columns.numbers[name].push_back(flight.metrics.number(i));
    }
    digests.push_back(flight.digest);
  });
  return nb::make_tuple(arrays_of(std::move(columns)), digests);
}

void add_steps(Columns& columns, Names& pilots, const flight::FlightRecord& record, const flight::Costs& costs) {
  const auto number = [&](const char* name, auto value) {
    std::vector<double>& column = columns.numbers[name];
    for (std::size_t i = 0; i < record.steps.size(); ++i) column.push_back(value(i, record.steps[i]));
  };
  const auto integer = [&](const char* name, auto value) {
    std::vector<std::int64_t>& column = columns.integers[name];
    for (const flight::StepRecord& step : record.steps) column.push_back(value(step));
  };
  const auto thought = [&](const char* name, auto value) {
    number(name, [&](std::size_t, const flight::StepRecord& step) {
      return step.introspection ? value(*step.introspection) : std::numeric_limits<double>::quiet_NaN();
    });
  };
  using Step = flight::StepRecord;
  using Thoughts = agents::Introspection;
  integer("step", [](const Step& step) { return step.step; });
  integer("action", [](const Step& step) { return static_cast<std::int64_t>(step.action); });
  integer("flown_by", [&](const Step& step) { return pilots.number(record.pilots.at(step.flown_by)); });
  number("x_m", [](std::size_t, const Step& step) { return step.x_m; });
  number("y_m", [](std::size_t, const Step& step) { return step.y_m; });
  number("height_m", [](std::size_t, const Step& step) { return step.height_m; });
  integer("serving_cell", [](const Step& step) { return step.serving_cell; });
  number("serving_sinr_db", [](std::size_t, const Step& step) { return step.serving_sinr_db; });
  number("qos", [](std::size_t, const Step& step) { return step.qos; });
  number("reward", [](std::size_t, const Step& step) { return step.reward; });
  number("energy_j", [&](std::size_t i, const Step&) { return record.step_energy_j(i, costs); });
  thought("epsilon", [](const Thoughts& thoughts) { return thoughts.epsilon; });
  thought("loss", [](const Thoughts& thoughts) { return thoughts.loss; });
  thought("q_down", [](const Thoughts& thoughts) { return thoughts.q_values[0]; });
  thought("q_hold", [](const Thoughts& thoughts) { return thoughts.q_values[1]; });
  thought("q_up", [](const Thoughts& thoughts) { return thoughts.q_values[2]; });
}

/// The columns of the steps of all flights, and the names of the agents that flew them.
nb::tuple steps(const ResultStore& results) {
  Columns columns;
  Names pilots;
  const experiment::Experiment& experiment = results.experiment();
  results.for_each_flight([&](const store::FlightSummary& flight) {
    const flight::FlightRecord record = store::decode_trace(results.trace(flight.key));
    for (std::size_t i = 0; i < record.steps.size(); ++i) add_key(columns, experiment, flight.key);
    add_steps(columns, pilots, record, experiment.costs_in(experiment.conditions.at(flight.key.condition)));
  });
  return nb::make_tuple(arrays_of(std::move(columns)), pilots.all());
}

nb::list conditions(const ResultStore& results) {
  nb::list all;
  for (const experiment::Condition& condition : results.experiment().conditions)
    all.append(
        nb::make_tuple(condition.name, condition.parameters.dump(), std::string(experiment::qos_unit(condition.kind))));
  return all;
}

nb::list agents_of(const ResultStore& results) {
  nb::list all;
  for (const agents::AgentSpec& spec : results.experiment().agents)
    all.append(nb::make_tuple(spec.name, spec.type, std::string(agents::privilege_tier(spec.privilege()).name)));
  return all;
}

}  // namespace

void define_results(nb::module_& m) {
  nb::class_<ResultStore>(m, "Results", "A result folder, read only.")
      .def_static("open", &ResultStore::open_for_reading, "folder"_a,
                  nb::sig("def open(folder: str | os.PathLike[str]) -> Results"))
      .def_prop_ro("seed", [](const ResultStore& results) { return results.experiment().seed; })
      .def_prop_ro(
          "experiment", [](const ResultStore& results) { return results.experiment().canonical.dump(); },
          "The resolved experiment, JSON.")
      .def_prop_ro("conditions", &conditions, "Name, swept parameters (JSON) and unit of quality of each.",
                   nb::sig("def conditions(self, /) -> list[tuple[str, str, str]]"))
      .def_prop_ro("agents", &agents_of, "Name, type and privilege of each.",
                   nb::sig("def agents(self, /) -> list[tuple[str, str, str]]"))
      .def("flights", &flights, "The columns of the flights, and their digests.",
           nb::sig("def flights(self) -> tuple[dict[str, numpy.typing.NDArray[typing.Any]], list[str]]"))
      .def("steps", &steps, "The columns of the steps, and the names that 'flown_by' counts.",
           nb::sig("def steps(self) -> tuple[dict[str, numpy.typing.NDArray[typing.Any]], list[str]]"));
  nb::list metrics;
  for (const flight::Metric& metric : flight::metrics()) metrics.append(std::string(metric.key));
  m.attr("METRICS") = nb::tuple(metrics);
}

}  // namespace aloft::python
