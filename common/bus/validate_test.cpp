// Every limit of the wire: a good sample of each type, and each way to spoil it.
#include "common/bus/validate.hpp"

#include <catch2/catch.hpp>
#include <functional>
#include <limits>
#include <string>
#include <utility>
#include <vector>

namespace aloft {
namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();
constexpr double infinity = std::numeric_limits<double>::infinity();

template <class T>
using Spoilers = std::vector<std::pair<const char*, std::function<void(T&)>>>;

template <class T>
void check(const T& good, const Spoilers<T>& spoilers) {
  const char* error = bus::validate(good);
  CHECK(error == nullptr);
  for (const auto& [expected, spoil] : spoilers) {
    T bad = good;
    spoil(bad);
    error = bus::validate(bad);
    INFO(expected);
    REQUIRE(error != nullptr);
    CHECK_THAT(error, Catch::Matchers::Contains(expected));
  }
}

}  // namespace

TEST_CASE("limits of the samples that steer a run") {
  wire::RunControl control;
  check<wire::RunControl>(control, {{"state", [](auto& s) { s.state(static_cast<wire::RunState>(4)); }},
                                    {"experiment_json", [](auto& s) { s.experiment_json().resize(1048577); }}});
  wire::TrialAssignment assignment;
  assignment.worker(wire::name("w0"));
  assignment.agents({wire::name("dqn")});
  check<wire::TrialAssignment>(assignment, {{"worker", [](auto& s) { s.worker(wire::name("")); }},
                                            {"agents", [](auto& s) { s.agents().resize(65); }},
                                            {"agents", [](auto& s) { s.agents().clear(); }},
                                            {"agents", [](auto& s) { s.cancelled(true); }}});
  wire::WorkerStatus worker;
  worker.worker(wire::name("w0"));
  check<wire::WorkerStatus>(worker, {{"worker", [](auto& s) { s.worker(wire::name("")); }},
                                     {"capacity", [](auto& s) { s.capacity(65); }},
                                     {"leases", [](auto& s) { s.leases().resize(65); }},
                                     {"failures", [](auto& s) { s.failures().resize(65); }}});
  wire::RunStatus run;
  check<wire::RunStatus>(run, {{"state", [](auto& s) { s.state(static_cast<wire::RunState>(99)); }},
                               {"flights_per_s", [](auto& s) { s.flights_per_s(nan); }},
                               {"flights_per_s", [](auto& s) { s.flights_per_s(-1); }},
                               {"steps_per_s", [](auto& s) { s.steps_per_s(infinity); }}});
}

TEST_CASE("limits of the samples about finished flights") {
  wire::EpisodeRecord record;
  record.agent(wire::name("dqn"));
  record.trace({1});
  check<wire::EpisodeRecord>(record, {{"agent", [](auto& s) { s.agent(wire::name("")); }},
                                      {"trace", [](auto& s) { s.trace().clear(); }},
                                      {"trace", [](auto& s) { s.trace().resize(4194305); }},
                                      {"agent_memory", [](auto& s) { s.agent_memory().resize(16777217); }}});
  wire::EpisodeStored stored;
  stored.digest(std::string(64, 'a'));
  check<wire::EpisodeStored>(stored, {{"digest", [](auto& s) { s.digest(std::string(63, 'a')); }}});
  wire::RecordRefused refused;
  refused.digest(std::string(64, 'a'));
  check<wire::RecordRefused>(refused, {{"digest", [](auto& s) { s.digest(""); }}});
  wire::FlightMemory memory;
  memory.memory({1});
  check<wire::FlightMemory>(memory, {{"stream", [](auto& s) { s.stream(1024); }},
                                     {"memory", [](auto& s) { s.memory().clear(); }},
                                     {"memory", [](auto& s) { s.memory().resize(16777217); }}});
  wire::MemoryRequest request;
  request.agent(wire::name("dqn"));
  check<wire::MemoryRequest>(request, {{"agent", [](auto& s) { s.agent(wire::name("")); }}});
  wire::StoredMemory answer;
  answer.agent(wire::name("dqn"));
  answer.memory({1});
  check<wire::StoredMemory>(answer, {{"agent", [](auto& s) { s.agent(wire::name("")); }},
                                     {"memory", [](auto& s) { s.memory().clear(); }},
                                     {"memory", [](auto& s) { s.memory().resize(16777217); }}});
  wire::CollectorStatus collector;
  check<wire::CollectorStatus>(collector, {{"state", [](auto& s) { s.state(static_cast<wire::CollectorState>(3)); }}});
}

TEST_CASE("limits of worlds") {
  wire::World world;
  world.agents({wire::name("dqn")});
  world.kind(wire::WORLD_CITY);
  world.city().window_m(1000);
  world.city().base_station_height_m(30);
  world.city().base_stations().resize(2);
  world.city().buildings_x(2);
  world.city().buildings_y(3);
  world.city().building_width_m(10);
  world.city().building_height_m({1, 2, 3, 4, 5, 6});
  check<wire::World>(world, {{"kind", [](auto& s) { s.kind(static_cast<wire::WorldKind>(4)); }},
                             {"agents", [](auto& s) { s.agents().resize(65); }},
                             {"window_m", [](auto& s) { s.city().window_m(0); }},
                             {"window_m", [](auto& s) { s.city().window_m(nan); }},
                             {"base_station_height_m", [](auto& s) { s.city().base_station_height_m(infinity); }},
                             {"base_stations", [](auto& s) { s.city().base_stations().clear(); }},
                             {"buildings_x",
                              [](auto& s) {
                                s.city().buildings_y(0);
                                s.city().building_height_m().clear();
                              }},
                             {"base_stations", [](auto& s) { s.city().base_stations().resize(131073); }},
                             {"base_stations", [](auto& s) { s.city().base_stations()[1].y_m(nan); }},
                             {"building_width_m", [](auto& s) { s.city().building_width_m(-1); }},
                             {"building_height_m", [](auto& s) { s.city().building_height_m()[5] = nan; }},
                             {"building_height_m", [](auto& s) { s.city().building_height_m().pop_back(); }},
                             {"building_height_m", [](auto& s) {
                                s.city().buildings_x(0xFFFFFFFF);
                                s.city().buildings_y(0xFFFFFFFF);
                              }}});
  world.kind(wire::WORLD_MEASURED);
  world.measured().height_step_m(10);
  world.measured().heights(2);
  world.measured().steps(2);
  world.measured().throughput_kbps({1, 2, 3, 4});
  world.measured().sinr_db({1, 2, 3, 4});
  check<wire::World>(world, {{"steps", [](auto& s) { s.measured().steps(0); }},
                             {"steps", [](auto& s) { s.measured().steps(16385); }},
                             {"heights", [](auto& s) { s.measured().heights(0); }},
                             {"heights", [](auto& s) { s.measured().heights(0xFFFFFFFF); }},
                             {"height_min_m", [](auto& s) { s.measured().height_min_m(nan); }},
                             {"height_step_m", [](auto& s) { s.measured().height_step_m(0); }},
                             {"throughput_kbps", [](auto& s) { s.measured().throughput_kbps().pop_back(); }},
                             {"throughput_kbps", [](auto& s) { s.measured().throughput_kbps()[0] = infinity; }},
                             {"sinr_db", [](auto& s) { s.measured().sinr_db().push_back(1); }},
                             {"sinr_db", [](auto& s) { s.measured().sinr_db()[3] = nan; }},
                             {"serving_cell", [](auto& s) { s.measured().serving_cell({1}); }}});
}

TEST_CASE("limits of the conversation in flight") {
  wire::ChannelReport report;
  report.height_min_m(40);
  report.height_max_m(240);
  report.height_step_m(10);
  report.steps(100);
  report.step(100);
  check<wire::ChannelReport>(report, {{"stream", [](auto& s) { s.stream(1024); }},
                                      {"qos_kind", [](auto& s) { s.qos_kind(static_cast<wire::QosKind>(2)); }},
                                      {"height_min_m", [](auto& s) { s.height_min_m(nan); }},
                                      {"height_max_m", [](auto& s) { s.height_max_m(39); }},
                                      {"height_step_m", [](auto& s) { s.height_step_m(0); }},
                                      {"steps", [](auto& s) { s.steps(0); }},
                                      {"steps", [](auto& s) { s.steps(16385); }},
                                      {"step", [](auto& s) { s.step(101); }},
                                      {"position", [](auto& s) { s.x_m(1e7); }},
                                      {"position", [](auto& s) { s.y_m(nan); }},
                                      {"height_m", [](auto& s) { s.height_m(infinity); }},
                                      {"serving_sinr_db", [](auto& s) { s.serving_sinr_db(nan); }},
                                      {"neighbour_sinr_db", [](auto& s) { s.neighbour_sinr_db().resize(6); }},
                                      {"neighbour_sinr_db", [](auto& s) { s.neighbour_sinr_db({nan}); }},
                                      {"qos", [](auto& s) { s.qos(nan); }},
                                      {"reward", [](auto& s) { s.reward(-infinity); }},
                                      {"executed", [](auto& s) { s.executed(static_cast<wire::Action>(5)); }}});
  wire::HeightCommand command;
  command.step(1);
  command.action(wire::ACTION_UP);
  check<wire::HeightCommand>(command, {{"stream", [](auto& s) { s.stream(0xFFFFFFFF); }},
                                       {"step", [](auto& s) { s.step(0); }},
                                       {"step", [](auto& s) { s.step(16385); }},
                                       {"action", [](auto& s) { s.action(wire::ACTION_NONE); }},
                                       {"action", [](auto& s) { s.action(static_cast<wire::Action>(6)); }},
                                       {"height_m", [](auto& s) { s.height_m(nan); }},
                                       {"epsilon", [](auto& s) { s.epsilon(1.5); }},
                                       {"loss", [](auto& s) { s.loss(infinity); }},
                                       {"q_values", [](auto& s) { s.q_values()[2] = nan; }}});
  wire::HeightProfile profile;
  profile.step(1);
  profile.resolution_m(1);
  profile.qos().assign(201, 2.5);
  check<wire::HeightProfile>(profile, {{"stream", [](auto& s) { s.stream(1024); }},
                                       {"step", [](auto& s) { s.step(0); }},
                                       {"height_min_m", [](auto& s) { s.height_min_m(nan); }},
                                       {"resolution_m", [](auto& s) { s.resolution_m(0); }},
                                       {"qos", [](auto& s) { s.qos().clear(); }},
                                       {"qos", [](auto& s) { s.qos().resize(4097); }},
                                       {"qos", [](auto& s) { s.qos()[200] = nan; }}});
  wire::AgentStatus agent;
  agent.agent(wire::name("dqn"));
  check<wire::AgentStatus>(agent, {{"agent", [](auto& s) { s.agent(wire::name("")); }},
                                   {"privilege", [](auto& s) { s.privilege(static_cast<wire::Privilege>(3)); }},
                                   {"state", [](auto& s) { s.state(static_cast<wire::AgentState>(4)); }}});
}

}  // namespace aloft
