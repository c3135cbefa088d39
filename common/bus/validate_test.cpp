// Every limit of the wire, and that each is checked.
#include "common/bus/validate.hpp"

#include <catch2/catch.hpp>
#include <fstream>
#include <iterator>
#include <map>
#include <regex>
#include <string>

#include "common/base/limits.hpp"
#include "common/bus/testing/sample_limits.hpp"
#include "tests/paths.hpp"

namespace aloft {
namespace {

using bus::testing::infinity;
using bus::testing::nan;

template <class T>
void check(const T& good, const bus::testing::Spoilers<T>& spoilers) {
  const char* error = bus::validate(good);
  CHECK(error == nullptr);
  CHECK_FALSE(spoilers.empty());
  for (const auto& [expected, spoil] : spoilers) {
    T bad = good;
    spoil(bad);
    error = bus::validate(bad);
    INFO(expected);
    REQUIRE(error != nullptr);
    CHECK_THAT(error, Catch::Contains(expected));
  }
}

/// The bound of a sequence or text of idl/*.idl in the table of limits.
std::size_t bound_of(const std::string& type, const std::string& name) {
  static const std::map<std::string, std::size_t> sequences{{"agents", limits::agents},
                                                            {"flies_only", limits::agents},
                                                            {"leases", limits::leases},
                                                            {"refused", limits::refused_collectors},
                                                            {"failures", limits::failures_told},
                                                            {"experiment_json", limits::experiment_bytes},
                                                            {"trace", limits::trace_bytes},
                                                            {"agent_memory", limits::memory_bytes},
                                                            {"memory", limits::memory_bytes},
                                                            {"base_stations", limits::base_stations},
                                                            {"building_height_m", limits::cells},
                                                            {"throughput_kbps", limits::cells},
                                                            {"sinr_db", limits::cells},
                                                            {"serving_cell", limits::cells},
                                                            {"neighbour_sinr_db", limits::neighbours},
                                                            {"qos", limits::heights},
                                                            {"route", limits::steps},
                                                            {"sites", limits::base_stations},
                                                            {"radio_json", limits::radio_json_bytes}};
  if (type == "sequence") return sequences.at(name);
  if (name == "experiment_id") return 16;
  const bool for_people =
      name == "message" || name == "reason" || name == "error" || name == "missing" || name == "results";
  return for_people ? limits::message_bytes : limits::name_bytes;
}

}  // namespace

TEST_CASE("the limits of every topic"){
#define ALOFT_TOPIC(type, ...)                             \
  SECTION(#type) {                                         \
    using Limits = bus::testing::SampleLimits<wire::type>; \
    check<wire::type>(Limits::good(), Limits::spoilers()); \
  }
#include "common/bus/topics.def"
}

TEST_CASE("the limits of measured flights") {
  wire::World world = bus::testing::SampleLimits<wire::World>::good();
  world.kind(wire::WORLD_MEASURED);
  world.measured().height_step_m(10);
  world.measured().heights(2);
  world.measured().steps(2);
  world.measured().throughput_kbps({1, 2, 3, 4});
  world.measured().sinr_db({1, 2, 3, 4});
  check<wire::World>(world, {{"steps", [](auto& s) { s.measured().steps(0); }},
                             {"steps", [](auto& s) { s.measured().steps(limits::steps + 1); }},
                             {"heights", [](auto& s) { s.measured().heights(0); }},
                             {"heights", [](auto& s) { s.measured().heights(limits::heights + 1); }},
                             {"heights", [](auto& s) { s.measured().heights(0xFFFFFFFF); }},
                             {"height_min_m", [](auto& s) { s.measured().height_min_m(nan); }},
                             {"height_step_m", [](auto& s) { s.measured().height_step_m(0); }},
                             {"throughput_kbps", [](auto& s) { s.measured().throughput_kbps().pop_back(); }},
                             {"throughput_kbps", [](auto& s) { s.measured().throughput_kbps()[0] = infinity; }},
                             {"sinr_db", [](auto& s) { s.measured().sinr_db().push_back(1); }},
                             {"sinr_db", [](auto& s) { s.measured().sinr_db()[3] = nan; }},
                             {"serving_cell", [](auto& s) { s.measured().serving_cell({1}); }}});
}

TEST_CASE("the limits of what an operator knew of a measured flight") {
  wire::World world = bus::testing::SampleLimits<wire::World>::good();
  wire::MeasuredFlight& flight = world.measured();
  world.kind(wire::WORLD_MEASURED);
  flight.height_step_m(10);
  flight.heights(1);
  flight.steps(2);
  flight.throughput_kbps({1, 2});
  flight.sinr_db({1, 2});
  flight.sites().resize(2);
  flight.sites()[1].cell(2147483647);
  flight.route().resize(2);
  check<wire::World>(world,
                     {{"sites is empty", [](auto& s) { s.measured().sites().clear(); }},
                      {"sites too long", [](auto& s) { s.measured().sites().resize(limits::base_stations + 1); }},
                      {"route", [](auto& s) { s.measured().route().clear(); }},
                      {"route", [](auto& s) { s.measured().route().resize(3); }},
                      {"route", [](auto& s) { s.measured().route()[1].x_m(nan); }},
                      {"cell", [](auto& s) { s.measured().sites()[0].cell(-1); }},
                      {"position", [](auto& s) { s.measured().sites()[1].y_m(2e6); }},
                      {"azimuth_deg", [](auto& s) { s.measured().sites()[1].azimuth_deg(361); }},
                      {"antenna_height_m", [](auto& s) { s.measured().antenna_height_m(infinity); }},
                      {"power_w", [](auto& s) { s.measured().power_w(-1); }}});
}

TEST_CASE("the bounds in the IDL are those of the table of limits") {
  const std::regex bounded(R"((sequence|string)<(?:[^<>;]*(?:<[0-9]+>)?, *)?([0-9]+)>\s+(\w+);)");
  std::size_t found = 0;
  for (const char* file : {"control.idl", "flight.idl", "record.idl", "world.idl"}) {
    std::ifstream stream(test::source_dir() / "idl" / file);
    const std::string text{std::istreambuf_iterator<char>(stream), {}};
    for (std::sregex_iterator at(text.begin(), text.end(), bounded), end; at != end; ++at, ++found) {
      INFO(file << ": " << at->str());
      CHECK(std::stoull((*at)[2]) == bound_of((*at)[1], (*at)[3]));
    }
    CHECK_THAT(text, !Catch::Contains("sequence<octet>") && !Catch::Contains("string "));
  }
  CHECK(found > 50);
}

}  // namespace aloft
