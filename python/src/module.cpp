// The module aloft._core: Worlds and Fleet for Python. Everything that users see is in python/aloft.
#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>
#include <nanobind/stl/filesystem.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/shared_ptr.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/string_view.h>
#include <nanobind/stl/vector.h>

#include <cstring>
#include <utility>

#include "common/base/error.hpp"
#include "python/src/fleet.hpp"
#include "python/src/modules.hpp"

namespace nb = nanobind;
using namespace nb::literals;

namespace aloft::python {
namespace {

template <typename Value>
using Input = nb::ndarray<const Value, nb::ndim<1>, nb::c_contig, nb::device::cpu>;

template <typename Value>
std::span<const Value> span_of(const Input<Value>& array) {
  return {array.data(), array.size()};
}

/// An array that owns a copy of `values`.
nb::object array_of(std::vector<double> values, std::initializer_list<std::size_t> shape) {
  auto* const kept = new std::vector<double>(std::move(values));
  const nb::capsule owner(kept, [](void* memory) noexcept { delete static_cast<std::vector<double>*>(memory); });
  return nb::cast(nb::ndarray<nb::numpy, double>(kept->data(), shape, owner));
}

/// A column of the fleet, which the array keeps alive.
template <typename Value>
nb::object view_of(nb::handle fleet, void* memory, std::initializer_list<std::size_t> shape) {
  return nb::cast(nb::ndarray<nb::numpy, Value>(memory, shape, fleet));
}

nb::dict columns(nb::handle self) {
  auto& fleet = nb::cast<Fleet&>(self);
  Fleet::Columns& columns = fleet.columns();
  const std::size_t n = fleet.size();
  const std::size_t values = fleet.layout().size();
  nb::dict all;
  all["observation"] = view_of<float>(self, columns.observation.data(), {n, values});
  if (!columns.final_observation.empty())
    all["final_observation"] = view_of<float>(self, columns.final_observation.data(), {n, values});
  all["number"] = view_of<double>(self, columns.number.data(), {Fleet::numbers, n});
  all["integer"] = view_of<std::int64_t>(self, columns.integer.data(), {Fleet::integers, n});
  all["flag"] = view_of<bool>(self, columns.flag.data(), {Fleet::flags, n});
  if (!columns.profile.empty())
    all["profile"] = view_of<double>(self, columns.profile.data(), {n, columns.profile_steps, columns.profile_heights});
  return all;
}

nb::object positions(const std::vector<world::Position>& all) {
  std::vector<double> xy;
  for (const world::Position& one : all) xy.insert(xy.end(), {one.x_m, one.y_m});
  return array_of(std::move(xy), {all.size(), 2});
}

/// What a picture shows of a world.
nb::dict scene(const Worlds& worlds, std::uint32_t condition, std::uint64_t seed, std::uint32_t trial) {
  if (condition >= worlds.conditions().size()) throw InputError("there is no condition {}", condition);
  nb::dict shown;
  const experiment::TrialWorld world = worlds.world(condition, seed, trial);
  if (const auto* const city = std::get_if<world::City>(&world)) {
    shown["window_m"] = city->window_m;
    shown["base_stations_m"] = positions(city->base_stations);
    shown["building_width_m"] = city->building_width_m;
    shown["building_height_m"] = array_of(city->building_height_m, {city->buildings_y, city->buildings_x});
    return shown;
  }
  const auto& known = std::get<world::MeasuredWorld>(world).known;
  if (!known) return shown;
  std::vector<world::Position> sites;
  for (const world::Site& site : known->sites) sites.push_back(site.position);
  shown["base_stations_m"] = positions(sites);
  return shown;
}

nb::dict facts(const Environment& environment) {
  const agents::FlightInfo& info = environment.flight().info();
  nb::dict all;
  all["seed"] = info.seed;
  all["trial"] = info.trial;
  all["condition"] = environment.start().condition;
  all["steps"] = info.steps;
  all["height_min_m"] = info.height_min_m;
  all["height_max_m"] = info.height_max_m;
  all["route_m"] = positions(environment.route());
  all["throughput"] = info.qos == agents::QosKind::throughput;
  return all;
}

nb::object flown(const Environment& environment) {
  std::vector<double> rows;
  const world::Position origin = environment.origin();
  const flight::FlightRecord& record = environment.flight().record();
  rows.insert(rows.end(), {origin.x_m, origin.y_m, record.height_start_m, 0.0, -1.0});
  for (const flight::StepRecord& step : record.steps)
    rows.insert(rows.end(), {step.x_m, step.y_m, step.height_m, step.qos, static_cast<double>(step.serving_cell)});
  return array_of(std::move(rows), {record.steps.size() + 1, 5});
}

nb::object profiles(const Environment& environment) {
  const std::vector<agents::HeightProfile> all = environment.profiles();
  std::vector<double> values;
  for (const agents::HeightProfile& one : all) values.insert(values.end(), one.qos.begin(), one.qos.end());
  return array_of(std::move(values), {all.size(), all.empty() ? 0 : all.front().qos.size()});
}

nb::bytes trace(const Fleet& fleet, std::uint32_t index, const std::string& agent) {
  const std::string bytes = fleet.look(index, [&](const Environment& environment) { return environment.trace(agent); });
  return nb::bytes(bytes.data(), bytes.size());
}

nb::list fields(std::span<const Field> all) {
  nb::list list;
  for (const Field& field : all)
    list.append(nb::make_tuple(nb::str(field.name.data(), field.name.size()), field.values, field.low, field.high));
  return list;
}

void reset(Fleet& fleet, const Input<std::uint64_t>& seeds, const Input<std::uint32_t>& trials,
           const Input<std::uint32_t>& conditions, const Input<std::uint8_t>& chosen) {
  const std::size_t n = fleet.size();
  if (seeds.size() != n || trials.size() != n || conditions.size() != n || chosen.size() != n)
    throw InputError("give one seed, trial and condition for each of {} environments", n);
  std::vector<Start> starts(n);
  for (std::size_t i = 0; i < n; ++i) starts[i] = {seeds.data()[i], trials.data()[i], conditions.data()[i]};
  const nb::gil_scoped_release released;
  fleet.reset(starts, span_of(chosen));
}

void step(Fleet& fleet, const Input<std::int64_t>& actions) {
  const nb::gil_scoped_release released;
  fleet.step(span_of(actions));
}

/// Input that cannot be used, or is damaged, is a ValueError, or a FileNotFoundError if a file is not there.
void translate(const std::exception_ptr& error, void* /*unused*/) {
  try {
    std::rethrow_exception(error);
  } catch (const IntegrityError& damaged) {
    PyErr_SetString(PyExc_ValueError, damaged.what());
  } catch (const InputError& wrong) {
    const bool missing = std::strstr(wrong.what(), std::strerror(ENOENT)) != nullptr;
    PyErr_SetString(missing ? PyExc_FileNotFoundError : PyExc_ValueError, wrong.what());
  }
}

Choices choices(std::optional<double> energy_weight, std::optional<double> handover_cost,
                const std::vector<std::string>& tiers) {
  Choices all{.energy_weight = energy_weight, .handover_cost = handover_cost};
  for (const std::string& tier : tiers) all.privileges.push_back(agents::privilege_tier(tier).privilege);
  return all;
}

void define_worlds(nb::module_& m) {
  nb::class_<Worlds>(m, "Worlds", "The worlds of an experiment.")
      .def_static(
          "from_json",
          [](const std::string& world, std::optional<double> energy_weight, std::optional<double> handover_cost,
             const std::vector<std::string>& tiers) {
            return std::make_shared<Worlds>(std::string_view(world), choices(energy_weight, handover_cost, tiers));
          },
          "world"_a, "energy_weight"_a.none(), "handover_cost"_a.none(), "tiers"_a,
          "The worlds of a JSON text as \"world\" of an experiment file.")
      .def_static(
          "from_file",
          [](const std::filesystem::path& file, std::optional<double> energy_weight,
             std::optional<double> handover_cost, const std::vector<std::string>& tiers) {
            return std::make_shared<Worlds>(file, choices(energy_weight, handover_cost, tiers));
          },
          "file"_a, "energy_weight"_a.none(), "handover_cost"_a.none(), "tiers"_a, "The worlds of an experiment file.",
          nb::sig(
              "def from_file(file: str | os.PathLike[str], energy_weight: float | None, handover_cost: float | None, "
              "tiers: collections.abc.Sequence[str]) -> Worlds"))
      .def_prop_ro(
          "conditions",
          [](const Worlds& worlds) {
            std::vector<std::string> names;
            for (const experiment::Condition& one : worlds.conditions()) names.push_back(one.name);
            return names;
          },
          "The names of the conditions, in the order of their numbers.")
      .def("scene", &scene, "condition"_a, "seed"_a, "trial"_a, "What a picture shows of a world.",
           nb::sig("def scene(self, condition: int, seed: int, trial: int) -> dict[str, typing.Any]"));
}

void define_fleet(nb::module_& m) {
  nb::enum_<Autoreset>(m, "Autoreset")
      .value("DISABLED", Autoreset::disabled)
      .value("NEXT_STEP", Autoreset::next_step)
      .value("SAME_STEP", Autoreset::same_step);
  nb::enum_<Foresight>(m, "Foresight")
      .value("NONE", Foresight::none)
      .value("NEXT_STEP", Foresight::next_step)
      .value("WHOLE_ROUTE", Foresight::whole_route);
  nb::class_<Fleet>(m, "Fleet", "Environments that step together.")
      .def(
          "__init__",
          [](Fleet* self, std::shared_ptr<Worlds> worlds, std::uint32_t environments, std::uint32_t threads,
             std::uint32_t history, std::uint32_t sites, Foresight foresight, Autoreset autoreset) {
            new (self) Fleet(std::move(worlds), {.layout = {.history = history, .sites = sites},
                                                 .foresight = foresight,
                                                 .autoreset = autoreset,
                                                 .environments = environments,
                                                 .threads = threads});
          },
          "worlds"_a, "environments"_a, "threads"_a, "history"_a, "sites"_a, "foresight"_a, "autoreset"_a)
      .def("columns", &columns, "Arrays that show the memory into which reset and step write.",
           nb::sig("def columns(self) -> dict[str, numpy.typing.NDArray[typing.Any]]"))
      .def("reset", &reset, "seeds"_a.noconvert(), "trials"_a.noconvert(), "conditions"_a.noconvert(),
           "chosen"_a.noconvert())
      .def("step", &step, "actions"_a.noconvert())
      .def(
          "facts", [](const Fleet& fleet, std::uint32_t index) { return fleet.look(index, &facts); }, "index"_a,
          "What is flown.", nb::sig("def facts(self, index: int) -> dict[str, typing.Any]"))
      .def(
          "flown", [](const Fleet& fleet, std::uint32_t index) { return fleet.look(index, &flown); }, "index"_a,
          "The flight so far: x, y, height, quality and cell, first those before the first step, with quality 0 and "
          "cell -1.",
          nb::sig("def flown(self, index: int) -> numpy.typing.NDArray[numpy.float64]"))
      .def(
          "profiles", [](const Fleet& fleet, std::uint32_t index) { return fleet.look(index, &profiles); }, "index"_a,
          "Quality at every step and height of the flight.",
          nb::sig("def profiles(self, index: int) -> numpy.typing.NDArray[numpy.float64]"))
      .def("trace", &trace, "index"_a, "agent"_a,
           "The flight so far as the result database stores it, flown by an agent of this name.");
}

}  // namespace

NB_MODULE(_core, m) {
  nb::set_leak_warnings(false);  // at the interpreter's end: environments that were never closed are no fault
  nb::register_exception_translator(translate);
  define_worlds(m);
  define_fleet(m);
  define_observer(m);
  define_results(m);
  m.attr("REPORT_FIELDS") = fields(report_fields);
  m.attr("SITE_FIELDS") = fields(site_fields);
  m.attr("ROUTE_FIELDS") = fields(route_fields);
  m.attr("NUMBERS") = nb::make_tuple("reward", "height_m", "x_m", "y_m", "qos", "energy_j");
  m.attr("INTEGERS") = nb::make_tuple("serving_cell", "executed", "seed", "trial", "steps", "condition");
  m.attr("FLAGS") = nb::make_tuple("handover", "terminated", "stepped", "began", "foreseen");
}

}  // namespace aloft::python
