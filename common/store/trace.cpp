#include <fmt/format.h>
#include <google/protobuf/io/coded_stream.h>
#include <google/protobuf/io/zero_copy_stream_impl_lite.h>
#include <idl/trace.pb.h>

#include <algorithm>
#include <bit>

#include "common/base/error.hpp"
#include "common/base/limits.hpp"
#include "common/store/result_store.hpp"

namespace aloft::store {
namespace {

using flight::FlightRecord;
using flight::StepRecord;

constexpr std::uint32_t trace_version = 1;

bool same_bits(double a, double b) noexcept {
  return std::bit_cast<std::uint64_t>(a) == std::bit_cast<std::uint64_t>(b);
}

void put_steps(const std::vector<StepRecord>& steps, proto::Trace& trace) {
  for (const StepRecord& step : steps) {
    trace.add_action(static_cast<std::uint32_t>(step.action));
    trace.add_x_m(step.x_m);
    trace.add_y_m(step.y_m);
    trace.add_height_m(step.height_m);
    trace.add_serving_cell(step.serving_cell);
    trace.add_serving_sinr_db(step.serving_sinr_db);
    trace.add_qos(step.qos);
  }
}

/// The columns that are left out when they follow from the others.
void put_optional_columns(const std::vector<StepRecord>& steps, proto::Trace& trace) {
  bool numbered = true;
  bool one_pilot = true;
  bool reward_is_qos = true;
  for (std::size_t i = 0; i < steps.size(); ++i) {
    numbered = numbered && steps[i].step == i + 1;
    one_pilot = one_pilot && steps[i].flown_by == 0;
    reward_is_qos = reward_is_qos && same_bits(steps[i].reward, steps[i].qos);
  }
  for (const StepRecord& step : steps) {
    if (!numbered) trace.add_step(step.step);
    if (!one_pilot) trace.add_flown_by(step.flown_by);
    if (!reward_is_qos) trace.add_reward(step.reward);
  }
}

void put_introspection(const std::vector<StepRecord>& steps, proto::Trace& trace) {
  for (std::size_t i = 0; i < steps.size(); ++i) {
    const std::optional<agents::Introspection>& thoughts = steps[i].introspection;
    if (!thoughts) continue;
    trace.add_thoughts_row(static_cast<std::uint32_t>(i));
    trace.add_epsilon(thoughts->epsilon);
    trace.add_loss(thoughts->loss);
    trace.add_q_down(thoughts->q_values[0]);
    trace.add_q_hold(thoughts->q_values[1]);
    trace.add_q_up(thoughts->q_values[2]);
  }
}

void put_mobility(const std::vector<StepRecord>& steps, proto::Trace& trace) {
  for (std::size_t i = 0; i < steps.size(); ++i) {
    const flight::MobilityEvents& events = steps[i].mobility;
    if (events == flight::MobilityEvents{}) continue;
    trace.add_mobility_row(static_cast<std::uint32_t>(i));
    trace.add_handovers(events.handovers);
    trace.add_ping_pongs(events.ping_pongs);
    trace.add_radio_link_failures(events.radio_link_failures);
    trace.add_outage_s(events.outage_s);
  }
}

void require(bool holds, std::string_view what) {
  if (!holds) throw IntegrityError("the trace of a flight is damaged: {}", what);
}

bool is_name(const std::string& text) {
  return !text.empty() && text.size() <= limits::name_bytes &&
         std::ranges::all_of(text, [](char c) { return c > ' ' && c <= '~'; });
}

void check_columns(const proto::Trace& trace) {
  const int rows = trace.action_size();
  for (const int size : {trace.x_m_size(), trace.y_m_size(), trace.height_m_size(), trace.serving_cell_size(),
                         trace.serving_sinr_db_size(), trace.qos_size()})
    require(size == rows, "its columns have different lengths");
  for (const int size : {trace.step_size(), trace.reward_size(), trace.flown_by_size()})
    require(size == 0 || size == rows, "its columns have different lengths");
  for (const int size :
       {trace.epsilon_size(), trace.loss_size(), trace.q_down_size(), trace.q_hold_size(), trace.q_up_size()})
    require(size == trace.thoughts_row_size(), "its columns of introspection have different lengths");
  for (const int size :
       {trace.handovers_size(), trace.ping_pongs_size(), trace.radio_link_failures_size(), trace.outage_s_size()})
    require(size == trace.mobility_row_size(), "its columns of mobility have different lengths");
  require(rows == 0 || trace.pilots_size() > 0, "it names no pilot");
  require(std::ranges::all_of(trace.pilots(), is_name), "a pilot's name is not a name");
}

StepRecord step_at(const proto::Trace& trace, int row) {
  StepRecord step;
  step.step = trace.step_size() == 0 ? static_cast<std::uint32_t>(row) + 1 : trace.step(row);
  require(trace.action(row) <= static_cast<std::uint32_t>(agents::Action::absolute), "unknown action");
  step.action = static_cast<agents::Action>(trace.action(row));
  step.x_m = trace.x_m(row);
  step.y_m = trace.y_m(row);
  step.height_m = trace.height_m(row);
  step.serving_cell = trace.serving_cell(row);
  step.serving_sinr_db = trace.serving_sinr_db(row);
  step.qos = trace.qos(row);
  step.reward = trace.reward_size() == 0 ? step.qos : trace.reward(row);
  step.flown_by = trace.flown_by_size() == 0 ? 0 : trace.flown_by(row);
  require(step.flown_by < static_cast<std::uint32_t>(trace.pilots_size()), "unknown pilot");
  return step;
}

void take_introspection(const proto::Trace& trace, std::vector<StepRecord>& steps) {
  for (int i = 0; i < trace.thoughts_row_size(); ++i) {
    const std::uint32_t row = trace.thoughts_row(i);
    require(row < steps.size() && (i == 0 || row > trace.thoughts_row(i - 1)),
            "its rows of introspection are not in order");
    steps[row].introspection =
        agents::Introspection{trace.epsilon(i), trace.loss(i), {trace.q_down(i), trace.q_hold(i), trace.q_up(i)}};
  }
}

void take_mobility(const proto::Trace& trace, std::vector<StepRecord>& steps) {
  for (int i = 0; i < trace.mobility_row_size(); ++i) {
    const std::uint32_t row = trace.mobility_row(i);
    require(row < steps.size() && (i == 0 || row > trace.mobility_row(i - 1)), "its rows of mobility are not in order");
    steps[row].mobility = {trace.handovers(i), trace.ping_pongs(i), trace.radio_link_failures(i), trace.outage_s(i)};
  }
}

}  // namespace

std::string encode_trace(const FlightRecord& record) {
  proto::Trace trace;
  trace.set_version(trace_version);
  trace.set_qos_kind(static_cast<std::uint32_t>(record.qos_kind));
  trace.set_height_start_m(record.height_start_m);
  for (const std::string& pilot : record.pilots) trace.add_pilots(pilot);
  put_steps(record.steps, trace);
  put_optional_columns(record.steps, trace);
  put_introspection(record.steps, trace);
  put_mobility(record.steps, trace);

  std::string bytes;
  google::protobuf::io::StringOutputStream stream(&bytes);
  google::protobuf::io::CodedOutputStream coded(&stream);
  coded.SetSerializationDeterministic(true);
  trace.SerializeToCodedStream(&coded);
  coded.Trim();
  return bytes;
}

FlightRecord decode_trace(std::string_view bytes) {
  proto::Trace trace;
  require(trace.ParseFromArray(bytes.data(), static_cast<int>(bytes.size())), "not a Protobuf message of this type");
  require(trace.version() == trace_version,
          fmt::format("its format has version {}, this program reads version {}", trace.version(), trace_version));
  require(trace.GetReflection()->GetUnknownFields(trace).empty(), "unknown fields");
  require(trace.qos_kind() <= static_cast<std::uint32_t>(radio::QosKind::throughput), "unknown kind of quality");
  check_columns(trace);
  FlightRecord record;
  record.qos_kind = static_cast<radio::QosKind>(trace.qos_kind());
  record.height_start_m = trace.height_start_m();
  record.pilots.assign(trace.pilots().begin(), trace.pilots().end());
  record.steps.reserve(static_cast<std::size_t>(trace.action_size()));
  for (int row = 0; row < trace.action_size(); ++row) record.steps.push_back(step_at(trace, row));
  take_introspection(trace, record.steps);
  take_mobility(trace, record.steps);
  return record;
}

}  // namespace aloft::store
