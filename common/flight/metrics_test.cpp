#include "common/flight/metrics.hpp"

#include <catch2/catch.hpp>
#include <limits>
#include <map>
#include <set>
#include <string>

#include "common/base/error.hpp"

using namespace aloft;
using namespace aloft::flight;

namespace {

/// Two steps, at 40 and 60 m, that start at 40 m; served by cells 3 and 4.
FlightRecord two_steps(double qos) {
  FlightRecord record;
  record.height_start_m = 40.0;
  record.pilots = {"an-agent"};
  record.steps.push_back({1, agents::Action::hold, 0.0, 0.0, 40.0, 3, 1.0, qos, qos, 0, {}});
  record.steps.push_back({2, agents::Action::up, 10.0, 0.0, 60.0, 4, 1.0, 3 * qos, 3 * qos, 0, {}});
  return record;
}

}  // namespace

TEST_CASE("every metric of a flight equals the value computed by hand") {
  const MetricValues values = measure(two_steps(2.0), {});
  CHECK(values["qos_mean"] == 4.0);
  CHECK(values["height_mean_m"] == 50.0);
  CHECK(values["height_changes"] == 1.0);
  CHECK(values["handovers"] == 1.0);
  CHECK(values["energy_j"].value() == Approx(2 * 126.029 + 20.0 * 20.0 / 0.7).epsilon(1e-5));
  CHECK(values["ping_pongs"] == std::nullopt);
  CHECK(values["radio_link_failures"] == std::nullopt);
  CHECK(values["outage_s"] == 0.0);
  FlightRecord unknown_cells = two_steps(2.0);
  for (StepRecord& step : unknown_cells.steps) step.serving_cell = -1;
  CHECK(measure(unknown_cells, {})["handovers"] == std::nullopt);
}

TEST_CASE("outage is the time of the steps below the threshold where the strongest cell serves") {
  FlightRecord record = two_steps(2.0);
  record.steps[1].serving_sinr_db = -6.1;
  CHECK(measure(record, {.speed_m_per_s = 20.0})["outage_s"] == 0.5);  // 10 m
  CHECK(measure(record, {.speed_m_per_s = 20.0, .outage_threshold_db = -6.1})["outage_s"] == 0.0);
  CHECK(measure(record, {.step_length_m = 30.0, .outage_threshold_db = 1.5})["outage_s"] == 6.0);
}

TEST_CASE("where networks hand the UAV over, the events of the steps count") {
  FlightRecord record = two_steps(2.0);  // from cell 3 to 4, which need not be a handover
  record.steps[0].mobility = {2, 1, 0, 0.25};
  record.steps[1].mobility = {0, 0, 3, 0.5};
  const MetricValues values = measure(record, {.a3 = aloft::radio::A3Rules{}});
  CHECK(values["handovers"] == 2.0);
  CHECK(values["ping_pongs"] == 1.0);
  CHECK(values["radio_link_failures"] == 3.0);
  CHECK(values["outage_s"] == 0.75);
}

TEST_CASE("a flight without steps, and a metric that is not finite, are refused") {
  CHECK_THROWS_AS(measure({}, {}), IntegrityError);
  CHECK_THROWS_AS(measure(two_steps(std::numeric_limits<double>::infinity()), {}), IntegrityError);
  CHECK_THROWS_AS(metric_index("speed"), std::logic_error);
}

TEST_CASE("every metric has a unique key, a description and words for headings") {
  std::set<std::string_view> names;
  for (const Metric& metric : metrics()) {
    INFO(metric.key);
    CHECK(names.insert(metric.key).second);
    CHECK_FALSE((metric.mean_key.empty() || metric.name.empty() || metric.heading.empty()));
    CHECK((metric.mean_key == metric.key || names.insert(metric.mean_key).second));
    CHECK(metric.description.ends_with('.'));
    CHECK(metric.key.find_first_not_of("abcdefghijklmnopqrstuvwxyz0123456789_") == std::string_view::npos);
    CHECK((metric.unit.stored_per_shown > 0.0 && metric.unit.stored.empty() == metric.unit.shown.empty()));
  }
  CHECK(metrics()[quality].key == "qos_mean");
  CHECK(metrics()[quality].unit_in(radio::QosKind::throughput).stored == "kbit/s");
  CHECK(metrics()[quality].unit_in(radio::QosKind::spectral_efficiency).stored == "bit/s/Hz");
}

TEST_CASE("databases of format 3 have the columns of Aloft 0.2.0 in its order") {
  std::map<int, std::string_view> places;
  for (const Metric& metric : metrics())
    if (metric.format_3_place) places[*metric.format_3_place] = metric.key;
  CHECK(places == std::map<int, std::string_view>{
                      {0, "qos_mean"}, {1, "height_mean_m"}, {2, "height_changes"}, {3, "energy_j"}, {4, "handovers"}});
}
