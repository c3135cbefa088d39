// _core.Observer: what a policy sees of a flight that it flies over the bus.
#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>

#include "common/base/error.hpp"
#include "python/src/modules.hpp"
#include "python/src/observer.hpp"

namespace nb = nanobind;
using namespace nb::literals;

namespace aloft::python {
namespace {

template <typename Value>
Value field(nb::handle message, const char* name) {
  return nb::cast<Value>(message.attr(name));
}

/// The number of an enumerator of the bus, which is that of the domain.
int number(nb::handle message, const char* name) {
  return nb::cast<int>(message.attr(name).attr("value"));
}

world::Position position(nb::handle message) {
  return {field<double>(message, "x_m"), field<double>(message, "y_m")};
}

void begin(Observer& observer, nb::handle report) {
  agents::FlightInfo flight;
  flight.qos = static_cast<agents::QosKind>(number(report, "qos_kind"));
  flight.height_min_m = field<double>(report, "height_min_m");
  flight.height_max_m = field<double>(report, "height_max_m");
  flight.height_step_m = field<double>(report, "height_step_m");
  flight.steps = field<std::uint32_t>(report, "steps");
  observer.begin(flight);
}

/// An update has the route alone.
void survey(Observer& observer, nb::handle site_map) {
  if (!field<bool>(site_map, "update")) {
    std::vector<world::Site> sites;
    bool sectors = false;
    for (const nb::handle site : site_map.attr("sites")) {
      sites.push_back({field<std::int32_t>(site, "cell"), position(site), field<double>(site, "azimuth_deg")});
      sectors = sectors || number(site, "antenna") == 1;  // ANTENNA_SECTOR
    }
    observer.survey(std::move(sites), sectors);
  }
  std::vector<world::Position> route;
  for (const nb::handle point : site_map.attr("route")) route.push_back(position(point));
  observer.plan(field<std::uint32_t>(site_map, "step"), std::move(route));
}

nb::object note(Observer& observer, nb::handle report) {
  agents::Observation seen;
  seen.step = field<std::uint32_t>(report, "step");
  seen.height_m = field<double>(report, "height_m");
  seen.serving_cell = field<std::int32_t>(report, "serving_cell");
  seen.serving_sinr_db = field<double>(report, "serving_sinr_db");
  for (const nb::handle sinr_db : report.attr("neighbour_sinr_db")) {
    if (seen.neighbour_count == seen.neighbour_sinr_db.size())
      throw InputError("neighbour_sinr_db: a report has at most {} neighbours", seen.neighbour_sinr_db.size());
    seen.neighbour_sinr_db[seen.neighbour_count++] = nb::cast<double>(sinr_db);
  }
  seen.qos = field<double>(report, "qos");
  seen.executed = static_cast<agents::Action>(number(report, "executed"));
  seen.reward = field<double>(report, "reward");
  observer.note(seen, position(report));

  auto* const values = new std::vector<float>(observer.layout().size());
  const nb::capsule owner(values, [](void* memory) noexcept { delete static_cast<std::vector<float>*>(memory); });
  observer.write(*values);
  return nb::cast(nb::ndarray<nb::numpy, float>(values->data(), {values->size()}, owner));
}

}  // namespace

void define_observer(nb::module_& m) {
  nb::class_<Observer>(m, "Observer", "The flat observation of HeightEnv, from the samples of aloft.wire.")
      .def(
          "__init__",
          [](Observer* self, std::uint32_t history, std::uint32_t sites) {
            const Layout layout{.history = history, .sites = sites};
            check(layout);
            new (self) Observer(layout);
          },
          "history"_a, "sites"_a)
      .def("begin", &begin, "report"_a, "A flight begins, of which this is a ChannelReport.",
           nb::sig("def begin(self, report: typing.Any) -> None"))
      .def("survey", &survey, "site_map"_a, "Takes a SiteMap.",
           nb::sig("def survey(self, site_map: typing.Any) -> None"))
      .def("note", &note, "report"_a, "Takes the ChannelReport of a step; returns the observation.",
           nb::sig("def note(self, report: typing.Any) -> numpy.typing.NDArray[numpy.float32]"));
}

}  // namespace aloft::python
