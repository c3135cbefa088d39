#pragma once

// A good sample of every topic, and each way to spoil it: every limit of the wire. The unit test breaks them one by
// one, the fault tests send such samples into a running system.

#include <functional>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "common/base/limits.hpp"
#include "common/bus/wire.hpp"

namespace aloft::bus::testing {

/// What the refusal must name, and how a good sample becomes a bad one.
template <class T>
using Spoilers = std::vector<std::pair<const char*, std::function<void(T&)>>>;

inline constexpr double nan = std::numeric_limits<double>::quiet_NaN();
inline constexpr double infinity = std::numeric_limits<double>::infinity();
inline const std::string sha256(64, 'a');

/// good() and spoilers() of a topic's type. A topic of topics.def without them does not compile.
template <class T>
struct SampleLimits;

template <>
struct SampleLimits<wire::RunControl> {
  static wire::RunControl good() {
    wire::RunControl sample;
    sample.state(wire::RUN_FINISHED);
    return sample;
  }
  static Spoilers<wire::RunControl> spoilers() {
    return {{"state", [](auto& s) { s.state(static_cast<wire::RunState>(4)); }},
            {"coordinator", [](auto& s) { s.coordinator().since_s(253402300800); }},
            {"collector", [](auto& s) { s.collector().since_s(~std::uint64_t{0}); }},
            {"refused", [](auto& s) { s.refused().resize(limits::refused_collectors + 1); }},
            {"experiment_json", [](auto& s) { s.experiment_json().resize(limits::experiment_bytes + 1); }}};
  }
};

template <>
struct SampleLimits<wire::TrialAssignment> {
  static wire::TrialAssignment good() {
    wire::TrialAssignment sample;
    sample.worker("w0");
    sample.agents(wire::names({"dqn"}));
    return sample;
  }
  static Spoilers<wire::TrialAssignment> spoilers() {
    return {{"worker", [](auto& s) { s.worker(""); }},
            {"agents", [](auto& s) { s.agents().resize(limits::agents + 1); }},
            {"agents", [](auto& s) { s.agents().clear(); }},
            {"agents", [](auto& s) { s.cancelled(true); }}};
  }
};

template <>
struct SampleLimits<wire::WorkerStatus> {
  static wire::WorkerStatus good() {
    wire::WorkerStatus sample;
    sample.worker("stranger");
    sample.agents().resize(1);
    sample.answer_s(2.5);
    return sample;
  }
  static Spoilers<wire::WorkerStatus> spoilers() {
    return {{"worker", [](auto& s) { s.worker(""); }},
            {"capacity", [](auto& s) { s.capacity(limits::leases + 1); }},
            {"leases", [](auto& s) { s.leases().resize(limits::leases + 1); }},
            {"failures", [](auto& s) { s.failures().resize(limits::failures_told + 1); }},
            {"agents", [](auto& s) { s.agents().resize(limits::agents_told + 1); }},
            {"flies_only", [](auto& s) { s.flies_only().resize(limits::agents + 1); }},
            {"answer_s", [](auto& s) { s.answer_s(nan); }},
            {"answer_s", [](auto& s) { s.answer_s(-1e-9); }},
            {"answer_s", [](auto& s) { s.answer_s(infinity); }},
            {"state of an agent", [](auto& s) { s.agents()[0].state(static_cast<wire::AgentState>(4)); }},
            {"silent_s", [](auto& s) { s.agents()[0].silent_s(-1); }},
            {"silent_s", [](auto& s) { s.agents()[0].silent_s(nan); }}};
  }
};

template <>
struct SampleLimits<wire::RunStatus> {
  static wire::RunStatus good() {
    wire::RunStatus sample;
    return sample;
  }
  static Spoilers<wire::RunStatus> spoilers() {
    return {{"state", [](auto& s) { s.state(static_cast<wire::RunState>(99)); }},
            {"flights_per_s", [](auto& s) { s.flights_per_s(nan); }},
            {"flights_per_s", [](auto& s) { s.flights_per_s(-1); }},
            {"steps_per_s", [](auto& s) { s.steps_per_s(infinity); }}};
  }
};

template <>
struct SampleLimits<wire::EpisodeRecord> {
  static wire::EpisodeRecord good() {
    wire::EpisodeRecord sample;
    sample.agent("dqn");
    sample.trace({1});
    return sample;
  }
  static Spoilers<wire::EpisodeRecord> spoilers() {
    return {{"agent", [](auto& s) { s.agent(""); }},
            {"trace", [](auto& s) { s.trace().clear(); }},
            {"trace", [](auto& s) { s.trace().resize(limits::trace_bytes + 1); }},
            {"agent_memory", [](auto& s) { s.agent_memory().resize(limits::memory_bytes + 1); }}};
  }
};

template <>
struct SampleLimits<wire::EpisodeStored> {
  static wire::EpisodeStored good() {
    wire::EpisodeStored sample;
    sample.digest(sha256);
    return sample;
  }
  static Spoilers<wire::EpisodeStored> spoilers() {
    return {{"digest", [](auto& s) { s.digest(std::string(63, 'a')); }}};
  }
};

template <>
struct SampleLimits<wire::RecordRefused> {
  static wire::RecordRefused good() {
    wire::RecordRefused sample;
    sample.digest(sha256);
    return sample;
  }
  static Spoilers<wire::RecordRefused> spoilers() {
    return {{"digest", [](auto& s) { s.digest(""); }}};
  }
};

template <>
struct SampleLimits<wire::FlightMemory> {
  static wire::FlightMemory good() {
    wire::FlightMemory sample;
    sample.memory({1});
    return sample;
  }
  static Spoilers<wire::FlightMemory> spoilers() {
    return {{"stream", [](auto& s) { s.stream(limits::streams); }},
            {"memory", [](auto& s) { s.memory().clear(); }},
            {"memory", [](auto& s) { s.memory().resize(limits::memory_bytes + 1); }}};
  }
};

template <>
struct SampleLimits<wire::MemoryRequest> {
  static wire::MemoryRequest good() {
    wire::MemoryRequest sample;
    sample.agent("dqn");
    return sample;
  }
  static Spoilers<wire::MemoryRequest> spoilers() {
    return {{"agent", [](auto& s) { s.agent(""); }}};
  }
};

template <>
struct SampleLimits<wire::StoredMemory> {
  static wire::StoredMemory good() {
    wire::StoredMemory sample;
    sample.agent("dqn");
    sample.memory({1});
    return sample;
  }
  static Spoilers<wire::StoredMemory> spoilers() {
    return {{"agent", [](auto& s) { s.agent(""); }},
            {"memory", [](auto& s) { s.memory().clear(); }},
            {"memory", [](auto& s) { s.memory().resize(limits::memory_bytes + 1); }}};
  }
};

template <>
struct SampleLimits<wire::CollectorStatus> {
  static wire::CollectorStatus good() {
    wire::CollectorStatus sample;
    sample.collector().incarnation(1);
    sample.state(wire::COLLECTOR_FAILED);
    return sample;
  }
  static Spoilers<wire::CollectorStatus> spoilers() {
    return {{"collector", [](auto& s) { s.collector().incarnation(0); }},
            {"since_s", [](auto& s) { s.collector().since_s(253402300800); }},
            {"state", [](auto& s) { s.state(static_cast<wire::CollectorState>(3)); }}};
  }
};

template <>
struct SampleLimits<wire::World> {
  static wire::World good() {
    wire::World sample;
    sample.agents(wire::names({"dqn"}));
    sample.kind(wire::WORLD_CITY);
    sample.city().window_m(1000);
    sample.city().base_station_height_m(30);
    sample.city().base_stations().resize(2);
    sample.city().buildings_x(2);
    sample.city().buildings_y(3);
    sample.city().building_width_m(10);
    sample.city().building_height_m({1, 2, 3, 4, 5, 6});
    return sample;
  }
  static Spoilers<wire::World> spoilers() {
    return {{"kind", [](auto& s) { s.kind(static_cast<wire::WorldKind>(4)); }},
            {"agents", [](auto& s) { s.agents().resize(limits::agents + 1); }},
            {"window_m", [](auto& s) { s.city().window_m(0); }},
            {"window_m", [](auto& s) { s.city().window_m(nan); }},
            {"base_station_height_m", [](auto& s) { s.city().base_station_height_m(infinity); }},
            {"base_stations", [](auto& s) { s.city().base_stations().clear(); }},
            {"buildings_x",
             [](auto& s) {
               s.city().buildings_y(0);
               s.city().building_height_m().clear();
             }},
            {"base_stations", [](auto& s) { s.city().base_stations().resize(limits::base_stations + 1); }},
            {"base_stations", [](auto& s) { s.city().base_stations()[1].y_m(nan); }},
            {"building_width_m", [](auto& s) { s.city().building_width_m(-1); }},
            {"building_height_m", [](auto& s) { s.city().building_height_m()[5] = nan; }},
            {"building_height_m", [](auto& s) { s.city().building_height_m().pop_back(); }},
            {"building_height_m", [](auto& s) {
               s.city().buildings_x(0xFFFFFFFF);
               s.city().buildings_y(0xFFFFFFFF);
             }}};
  }
};

template <>
struct SampleLimits<wire::ChannelReport> {
  static wire::ChannelReport good() {
    wire::ChannelReport sample;
    sample.stream(limits::streams - 1);
    sample.height_min_m(40);
    sample.height_max_m(240);
    sample.height_step_m(10);
    sample.steps(100);
    sample.step(100);
    return sample;
  }
  static Spoilers<wire::ChannelReport> spoilers() {
    return {{"stream", [](auto& s) { s.stream(limits::streams); }},
            {"qos_kind", [](auto& s) { s.qos_kind(static_cast<wire::QosKind>(2)); }},
            {"height_min_m", [](auto& s) { s.height_min_m(nan); }},
            {"height_max_m", [](auto& s) { s.height_max_m(39); }},
            {"height_step_m", [](auto& s) { s.height_step_m(0); }},
            {"height_step_m", [](auto& s) { s.height_step_m(0.04); }},
            {"steps", [](auto& s) { s.steps(0); }},
            {"steps", [](auto& s) { s.steps(limits::steps + 1); }},
            {"step", [](auto& s) { s.step(101); }},
            {"position", [](auto& s) { s.x_m(1e7); }},
            {"position", [](auto& s) { s.y_m(nan); }},
            {"height_m", [](auto& s) { s.height_m(infinity); }},
            {"serving_sinr_db", [](auto& s) { s.serving_sinr_db(nan); }},
            {"neighbour_sinr_db", [](auto& s) { s.neighbour_sinr_db().resize(6); }},
            {"neighbour_sinr_db", [](auto& s) { s.neighbour_sinr_db({nan}); }},
            {"qos", [](auto& s) { s.qos(nan); }},
            {"reward", [](auto& s) { s.reward(-infinity); }},
            {"executed", [](auto& s) { s.executed(static_cast<wire::Action>(5)); }}};
  }
};

template <>
struct SampleLimits<wire::HeightCommand> {
  static wire::HeightCommand good() {
    wire::HeightCommand sample;
    sample.stream(limits::streams - 1);
    sample.step(1);
    sample.action(wire::ACTION_UP);
    return sample;
  }
  static Spoilers<wire::HeightCommand> spoilers() {
    return {{"stream", [](auto& s) { s.stream(0xFFFFFFFF); }},
            {"step", [](auto& s) { s.step(0); }},
            {"step", [](auto& s) { s.step(limits::steps + 1); }},
            {"action", [](auto& s) { s.action(wire::ACTION_NONE); }},
            {"action", [](auto& s) { s.action(static_cast<wire::Action>(6)); }},
            {"height_m", [](auto& s) { s.height_m(nan); }},
            {"epsilon", [](auto& s) { s.epsilon(1.5); }},
            {"loss", [](auto& s) { s.loss(infinity); }},
            {"q_values", [](auto& s) { s.q_values()[2] = nan; }}};
  }
};

template <>
struct SampleLimits<wire::ReportFollowed> {
  static wire::ReportFollowed good() {
    wire::ReportFollowed sample;
    sample.agent("dqn");
    sample.stream(limits::streams - 1);
    sample.step(limits::steps);
    return sample;
  }
  static Spoilers<wire::ReportFollowed> spoilers() {
    return {{"stream", [](auto& s) { s.stream(limits::streams); }},
            {"step", [](auto& s) { s.step(limits::steps + 1); }},
            {"agent", [](auto& s) { s.agent(""); }}};
  }
};

template <>
struct SampleLimits<wire::SwapRequest> {
  static wire::SwapRequest good() {
    wire::SwapRequest sample;
    sample.agent("dqn");
    sample.from_step(limits::steps);
    return sample;
  }
  static Spoilers<wire::SwapRequest> spoilers() {
    return {{"from_step", [](auto& s) { s.from_step(limits::steps + 1); }}, {"agent", [](auto& s) { s.agent(""); }}};
  }
};

template <>
struct SampleLimits<wire::SwapReply> {
  static wire::SwapReply good() {
    wire::SwapReply sample;
    sample.accepted(true);
    return sample;
  }
  static Spoilers<wire::SwapReply> spoilers() {
    return {{"message", [](auto& s) { s.accepted(false); }}, {"message", [](auto& s) { s.message("but why"); }}};
  }
};

template <>
struct SampleLimits<wire::AgentStatus> {
  static wire::AgentStatus good() {
    wire::AgentStatus sample;
    sample.agent("dqn");
    return sample;
  }
  static Spoilers<wire::AgentStatus> spoilers() {
    return {{"agent", [](auto& s) { s.agent(""); }},
            {"privilege", [](auto& s) { s.privilege(static_cast<wire::Privilege>(4)); }},
            {"state", [](auto& s) { s.state(static_cast<wire::AgentState>(4)); }}};
  }
};

template <>
struct SampleLimits<wire::SiteMap> {
  static wire::SiteMap good() {
    wire::SiteMap sample;
    sample.stream(limits::streams - 1);
    sample.step(limits::steps - 1);
    sample.route().resize(3);
    sample.sites().resize(2);
    sample.radio_json() = {'{', '}'};
    return sample;
  }
  static Spoilers<wire::SiteMap> spoilers() {
    return {{"stream", [](auto& s) { s.stream(limits::streams); }},
            {"step", [](auto& s) { s.step(limits::steps); }},
            {"position_error_m", [](auto& s) { s.position_error_m(-1); }},
            {"missing", [](auto& s) { s.missing(1.5); }},
            {"route_points", [](auto& s) { s.route_points(limits::steps + 1); }},
            {"route", [](auto& s) { s.route().clear(); }},
            {"route", [](auto& s) { s.route().resize(limits::steps + 1); }},
            {"route", [](auto& s) { s.route()[2].y_m(nan); }},
            {"sites", [](auto& s) { s.sites().resize(limits::base_stations + 1); }},
            {"sites",
             [](auto& s) {
               s.update(true);
               s.radio_json().clear();
             }},
            {"radio_json", [](auto& s) { s.radio_json().clear(); }},
            {"radio_json", [](auto& s) { s.radio_json().resize(limits::radio_json_bytes + 1); }},
            {"radio_json",
             [](auto& s) {
               s.update(true);
               s.sites().clear();
             }},
            {"cell", [](auto& s) { s.sites()[0].cell(-1); }},
            {"position of a site", [](auto& s) { s.sites()[1].x_m(2e6); }},
            {"antenna_height_m", [](auto& s) { s.sites()[1].antenna_height_m(nan); }},
            {"power_w", [](auto& s) { s.sites()[1].power_w(-1); }},
            {"antenna", [](auto& s) { s.sites()[1].antenna(static_cast<wire::AntennaKind>(2)); }},
            {"azimuth_deg", [](auto& s) { s.sites()[1].azimuth_deg(400); }}};
  }
};

template <>
struct SampleLimits<wire::HeightProfile> {
  static wire::HeightProfile good() {
    wire::HeightProfile sample;
    sample.stream(limits::streams - 1);
    sample.step(1);
    sample.resolution_m(1);
    sample.qos().assign(201, 2.5);
    return sample;
  }
  static Spoilers<wire::HeightProfile> spoilers() {
    return {{"stream", [](auto& s) { s.stream(limits::streams); }},
            {"step", [](auto& s) { s.step(0); }},
            {"step", [](auto& s) { s.step(limits::steps + 1); }},
            {"height_min_m", [](auto& s) { s.height_min_m(nan); }},
            {"resolution_m", [](auto& s) { s.resolution_m(0); }},
            {"qos", [](auto& s) { s.qos().clear(); }},
            {"qos", [](auto& s) { s.qos().resize(limits::heights + 1); }},
            {"qos", [](auto& s) { s.qos()[200] = nan; }}};
  }
};

}  // namespace aloft::bus::testing
