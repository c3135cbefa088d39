#include "common/bus/validate.hpp"

#include <algorithm>
#include <cmath>
#include <span>

#include "common/base/limits.hpp"
#include "common/base/process_name.hpp"
#include "common/bus/topics.hpp"

namespace aloft::bus {
namespace {

bool within(double value, double low, double high) noexcept {
  return value >= low && value <= high;
}
bool height(double value) noexcept {
  return within(value, -limits::height_m, limits::height_m);
}
bool distance(double value) noexcept {
  return within(value, -limits::distance_m, limits::distance_m);
}
bool level(double value) noexcept {
  return within(value, -limits::level_db, limits::level_db);
}
bool quality(double value) noexcept {
  return within(value, -limits::quality, limits::quality);
}

bool all(std::span<const double> values, bool (*good)(double) noexcept) noexcept {
  return std::all_of(values.begin(), values.end(), good);
}

template <class Enum>
bool up_to(Enum value, Enum last) noexcept {
  return static_cast<std::uint32_t>(value) <= static_cast<std::uint32_t>(last);
}

bool dated(const wire::ProcessName& process) noexcept {
  return process.since_s() <= latest_since_s;
}

const char* city_error(const wire::City& city) noexcept {
  if (!within(city.window_m(), 1.0, limits::distance_m)) return "city.window_m out of range";
  if (!height(city.base_station_height_m())) return "city.base_station_height_m out of range";
  if (!within(city.building_width_m(), 0.0, limits::distance_m)) return "city.building_width_m out of range";
  if (city.base_stations().empty()) return "city.base_stations is empty";
  if (city.base_stations().size() > limits::base_stations) return "city.base_stations too long";
  if ((city.buildings_x() == 0) != (city.buildings_y() == 0)) return "city.buildings_x or buildings_y is 0";
  if (city.building_height_m().size() > limits::cells) return "city.building_height_m too long";
  if (std::uint64_t{city.buildings_x()} * city.buildings_y() != city.building_height_m().size())
    return "city.building_height_m is not buildings_x * buildings_y long";
  if (!all(city.building_height_m(), height)) return "city.building_height_m out of range";
  for (const wire::Position& position : city.base_stations())
    if (!distance(position.x_m()) || !distance(position.y_m())) return "city.base_stations out of range";
  return nullptr;
}

const char* measured_error(const wire::MeasuredFlight& flight) noexcept {
  const std::uint64_t cells = std::uint64_t{flight.heights()} * flight.steps();
  if (flight.steps() < 1 || flight.steps() > limits::steps) return "measured.steps out of range";
  if (flight.heights() < 1 || flight.heights() > limits::heights || cells > limits::cells)
    return "measured.heights out of range";
  if (!height(flight.height_min_m())) return "measured.height_min_m out of range";
  if (!within(flight.height_step_m(), limits::height_step_min_m, limits::height_m))
    return "measured.height_step_m out of range";
  if (flight.throughput_kbps().size() != cells) return "measured.throughput_kbps is not steps * heights long";
  if (flight.sinr_db().size() != cells) return "measured.sinr_db is not steps * heights long";
  if (!flight.serving_cell().empty() && flight.serving_cell().size() != cells)
    return "measured.serving_cell is not steps * heights long";
  if (!all(flight.throughput_kbps(), quality)) return "measured.throughput_kbps out of range";
  if (!all(flight.sinr_db(), level)) return "measured.sinr_db out of range";
  return nullptr;
}

bool stream(std::uint32_t value) noexcept {
  return value < static_cast<std::uint32_t>(topic_settings<wire::ChannelReport>().keys);
}

const char* memory_error(const std::vector<std::uint8_t>& memory) noexcept {
  if (memory.empty()) return "memory is empty";
  return memory.size() > limits::memory_bytes ? "memory too long" : nullptr;
}

const char* limits_error(const wire::ChannelReport& report) noexcept {
  if (!up_to(report.qos_kind(), wire::QOS_THROUGHPUT)) return "unknown qos_kind";
  if (!height(report.height_min_m())) return "height_min_m out of range";
  if (!within(report.height_max_m(), report.height_min_m(), limits::height_m)) return "height_max_m out of range";
  if (!within(report.height_step_m(), limits::height_step_min_m, limits::height_m)) return "height_step_m out of range";
  if (report.steps() < 1 || report.steps() > limits::steps) return "steps out of range";
  return nullptr;
}

}  // namespace

const char* validate(const wire::RunControl& sample) noexcept {
  if (!up_to(sample.state(), wire::RUN_FAILED)) return "unknown state";
  if (!dated(sample.coordinator())) return "coordinator.since_s out of range";
  if (!dated(sample.collector())) return "collector.since_s out of range";
  if (sample.refused().size() > limits::refused_collectors) return "refused too long";
  if (sample.experiment_json().size() > limits::experiment_bytes) return "experiment_json too long";
  return nullptr;
}

const char* validate(const wire::TrialAssignment& sample) noexcept {
  if (wire::view(sample.worker()).empty()) return "worker is empty";
  if (sample.agents().size() > limits::agents) return "agents too long";
  if (sample.agents().empty() != sample.cancelled()) return "agents must be empty if cancelled, and only then";
  return nullptr;
}

const char* validate(const wire::WorkerStatus& sample) noexcept {
  if (wire::view(sample.worker()).empty()) return "worker is empty";
  if (sample.capacity() > limits::leases) return "capacity out of range";
  if (sample.leases().size() > limits::leases) return "leases too long";
  if (sample.failures().size() > limits::failures_told) return "failures too long";
  if (sample.agents().size() > limits::agents_told) return "agents too long";
  if (sample.flies_only().size() > limits::agents) return "flies_only too long";
  if (!within(sample.answer_s(), 0.0, 1e12)) return "answer_s out of range";
  for (const wire::AgentNews& agent : sample.agents()) {
    if (!up_to(agent.state(), wire::AGENT_STOPPED)) return "unknown state of an agent";
    if (!within(agent.silent_s(), 0.0, 1e12)) return "silent_s of an agent out of range";
  }
  return nullptr;
}

const char* validate(const wire::RunStatus& sample) noexcept {
  if (!up_to(sample.state(), wire::RUN_FAILED)) return "unknown state";
  if (!within(sample.flights_per_s(), 0.0, 1e12)) return "flights_per_s out of range";
  if (!within(sample.steps_per_s(), 0.0, 1e12)) return "steps_per_s out of range";
  return nullptr;
}

const char* validate(const wire::EpisodeRecord& sample) noexcept {
  if (wire::view(sample.agent()).empty()) return "agent is empty";
  if (sample.trace().empty()) return "trace is empty";
  if (sample.trace().size() > limits::trace_bytes) return "trace too long";
  if (sample.agent_memory().size() > limits::memory_bytes) return "agent_memory too long";
  return nullptr;
}

const char* validate(const wire::RecordRefused& sample) noexcept {
  return wire::view(sample.digest()).size() == 64 ? nullptr : "digest is no SHA-256";
}

const char* validate(const wire::FlightMemory& sample) noexcept {
  if (!stream(sample.stream())) return "stream out of range";
  return memory_error(sample.memory());
}

const char* validate(const wire::MemoryRequest& sample) noexcept {
  return wire::view(sample.agent()).empty() ? "agent is empty" : nullptr;
}

const char* validate(const wire::StoredMemory& sample) noexcept {
  if (wire::view(sample.agent()).empty()) return "agent is empty";
  return memory_error(sample.memory());
}

const char* validate(const wire::EpisodeStored& sample) noexcept {
  return wire::view(sample.digest()).size() == 64 ? nullptr : "digest is no SHA-256";
}

const char* validate(const wire::CollectorStatus& sample) noexcept {
  if (sample.collector().incarnation() == 0) return "collector is nobody";
  if (!dated(sample.collector())) return "collector.since_s out of range";
  return up_to(sample.state(), wire::COLLECTOR_FAILED) ? nullptr : "unknown state";
}

const char* validate(const wire::World& sample) noexcept {
  if (sample.agents().size() > limits::agents) return "agents too long";
  switch (sample.kind()) {
    case wire::WORLD_CITY:
      return city_error(sample.city());
    case wire::WORLD_MEASURED:
      return measured_error(sample.measured());
    case wire::WORLD_CANCELLED:
    case wire::WORLD_FAILED:
      return nullptr;
  }
  return "unknown kind";
}

const char* validate(const wire::ChannelReport& sample) noexcept {
  if (!stream(sample.stream())) return "stream out of range";
  if (const char* error = limits_error(sample)) return error;
  if (sample.step() > sample.steps()) return "step out of range";
  if (!distance(sample.x_m()) || !distance(sample.y_m())) return "position out of range";
  if (!height(sample.height_m())) return "height_m out of range";
  if (!level(sample.serving_sinr_db())) return "serving_sinr_db out of range";
  if (sample.neighbour_sinr_db().size() > limits::neighbours) return "neighbour_sinr_db too long";
  if (!all(sample.neighbour_sinr_db(), level)) return "neighbour_sinr_db out of range";
  if (!quality(sample.qos())) return "qos out of range";
  if (!within(sample.reward(), -limits::reward, limits::reward)) return "reward out of range";
  if (!up_to(sample.executed(), wire::ACTION_ABSOLUTE)) return "unknown executed action";
  return nullptr;
}

const char* validate(const wire::HeightCommand& sample) noexcept {
  if (!stream(sample.stream())) return "stream out of range";
  if (sample.step() < 1 || sample.step() > limits::steps) return "step out of range";
  if (sample.action() == wire::ACTION_NONE || !up_to(sample.action(), wire::ACTION_UNKNOWN_FLIGHT))
    return "unknown action";
  if (!height(sample.height_m())) return "height_m out of range";
  if (!within(sample.epsilon(), 0.0, 1.0)) return "epsilon out of range";
  if (!std::isfinite(sample.loss())) return "loss is not finite";
  if (!all(sample.q_values(), [](double value) noexcept { return std::isfinite(value); })) return "q_values not finite";
  return nullptr;
}

const char* validate(const wire::ReportFollowed& sample) noexcept {
  if (!stream(sample.stream())) return "stream out of range";
  if (sample.step() > limits::steps) return "step out of range";
  return wire::view(sample.agent()).empty() ? "agent is empty" : nullptr;
}

const char* validate(const wire::SwapRequest& sample) noexcept {
  if (sample.from_step() > limits::steps) return "from_step out of range";
  return wire::view(sample.agent()).empty() ? "agent is empty" : nullptr;
}

const char* validate(const wire::SwapReply& sample) noexcept {
  return sample.accepted() == wire::view(sample.message()).empty() ? nullptr : "a message says why not, and only then";
}

const char* validate(const wire::AgentStatus& sample) noexcept {
  if (!up_to(sample.privilege(), wire::PRIVILEGE_WHOLE_ROUTE)) return "unknown privilege";
  if (!up_to(sample.state(), wire::AGENT_STOPPED)) return "unknown state";
  if (wire::view(sample.agent()).empty()) return "agent is empty";
  return nullptr;
}

const char* validate(const wire::HeightProfile& sample) noexcept {
  if (!stream(sample.stream())) return "stream out of range";
  if (sample.step() < 1 || sample.step() > limits::steps) return "step out of range";
  if (!height(sample.height_min_m())) return "height_min_m out of range";
  if (!within(sample.resolution_m(), limits::height_step_min_m, limits::height_m)) return "resolution_m out of range";
  if (sample.qos().empty() || sample.qos().size() > limits::heights) return "qos has a wrong length";
  if (!all(sample.qos(), quality)) return "qos out of range";
  return nullptr;
}

}  // namespace aloft::bus
