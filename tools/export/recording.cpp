#include "tools/export/recording.hpp"

#include <fmt/format.h>
#include <google/protobuf/descriptor.pb.h>
#include <tools/export/step.pb.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <set>

#include "common/base/build_info.hpp"
#include "common/base/write_file.hpp"
#include "tools/export/action_name.hpp"
#include "tools/export/scene.hpp"
#include "tools/mcap/writer.hpp"
#include "tools/report/agent_list.hpp"

namespace aloft::exports {
namespace {

using store::FlightSummary;

/// Appends a file and, before it, those that it imports.
void add_with_imports(const google::protobuf::FileDescriptor& file, std::set<std::string>& have,
                      google::protobuf::FileDescriptorSet& to) {
  if (!have.insert(file.name()).second) return;
  for (int i = 0; i < file.dependency_count(); ++i) add_with_imports(*file.dependency(i), have, to);
  file.CopyTo(to.add_file());
}

template <typename Message>
std::uint16_t add_schema(mcap::Writer& writer) {
  google::protobuf::FileDescriptorSet files;
  std::set<std::string> have;
  add_with_imports(*Message::descriptor()->file(), have, files);
  return writer.add_schema(Message::descriptor()->full_name(), "protobuf", files.SerializeAsString());
}

/// By agent: as in the report.
std::map<std::string, foxglove::Color> colours_of(const experiment::Experiment& experiment) {
  report::ConditionTrials all;
  for (const agents::AgentSpec& agent : experiment.agents)
    all.agents.push_back({agent.name, agent.type, agent.privilege()});
  std::map<std::string, foxglove::Color> colours;
  for (const nlohmann::json& agent : report::agent_list({&all, 1}))
    colours[agent["name"]] = colour(agent["colour"]["light"]);
  return colours;
}

/// The topics of an agent, and how it is drawn.
struct Track {
  foxglove::Color colour;
  std::uint16_t scene;
  std::uint16_t location;
  std::uint16_t step;
};

/// A flight of the world that is written.
struct Flown {
  const agents::AgentSpec* agent;
  flight::FlightRecord record;
};

class Recording {
 public:
  Recording(const store::ResultStore& results, std::span<const FlightSummary> flights, mcap::Writer::Sink sink)
      : results_(results),
        experiment_(results.experiment()),
        writer_(std::move(sink), fmt::format("aloft {}", build_id())) {
    writer_.add_metadata("aloft", {{"experiment", experiment_.name},
                                   {"experiment_id", experiment_.id},
                                   {"seed", std::to_string(experiment_.seed)}});
    const std::uint16_t scene = add_schema<foxglove::SceneUpdate>(writer_);
    const std::uint16_t location = add_schema<foxglove::LocationFix>(writer_);
    const std::uint16_t step = add_schema<Step>(writer_);
    world_channel_ = writer_.add_channel(scene, "/world", "protobuf");
    const std::map<std::string, foxglove::Color> colours = colours_of(experiment_);
    for (const agents::AgentSpec& agent : experiment_.agents) {
      if (std::ranges::none_of(flights, [&](const auto& flight) { return flight.key.agent == agent.name; })) continue;
      const auto channel = [&](std::uint16_t schema, const char* topic) {
        return writer_.add_channel(schema, fmt::format("/{}/{}", agent.name, topic), "protobuf");
      };
      tracks_[agent.name] = {colours.at(agent.name), channel(scene, "scene"), channel(location, "location"),
                             channel(step, "step")};
    }
  }

  /// All flights of one world, side by side.
  void write_world(std::span<const FlightSummary> flights) {
    condition_ = &experiment_.conditions.at(flights.front().key.condition);
    trial_ = flights.front().key.trial;
    costs_ = experiment_.costs_in(*condition_);
    step_ns_ = static_cast<std::uint64_t>(std::llround(1e9 * costs_.step_length_m / costs_.speed_m_per_s));
    draw();
    std::vector<Flown> flown;
    for (const FlightSummary& flight : flights)
      flown.push_back({&experiment_.agent(flight.key.agent), store::decode_trace(results_.trace(flight.key))});
    put(world_channel_, begin_ns_, world_scene(world_, facts(), begin_ns_));
    for (const Flown& one : flown) write_way(one);
    std::size_t rows = 0;
    std::uint32_t last = 0;
    for (const Flown& one : flown) {
      rows = std::max(rows, one.record.steps.size());
      last = std::max(last, one.record.steps.back().step);
    }
    for (std::size_t row = 0; row < rows; ++row)
      for (const Flown& one : flown)
        if (row < one.record.steps.size()) write_step(one, row);
    begin_ns_ += (last + 1) * step_ns_;
  }

  void finish() { writer_.finish(); }

 private:
  /// A measured world is the same in all trials, and takes long to read.
  void draw() {
    if (drawn_ == condition_ && condition_->kind == experiment::WorldKind::measured) return;
    world_ = draw_world(experiment_, *condition_, trial_);
    drawn_ = condition_;
  }

  [[nodiscard]] std::map<std::string, std::string> facts() const {
    std::map<std::string, std::string> facts{{"condition", condition_->name}, {"trial", std::to_string(trial_)}};
    for (const auto& swept : condition_->parameters.items())
      facts[swept.key()] = swept.value().is_string() ? swept.value().get<std::string>() : swept.value().dump();
    return facts;
  }

  template <typename Message>
  void put(std::uint16_t channel, std::uint64_t time_ns, const Message& message) {
    writer_.write(channel, time_ns, message.SerializeAsString());
  }

  void write_way(const Flown& flown) {
    std::vector<foxglove::Point3> way;
    way.reserve(flown.record.steps.size());
    for (const flight::StepRecord& step : flown.record.steps)
      way.push_back(point(world_.position(step), step.height_m));
    const Track& track = tracks_.at(flown.agent->name);
    put(track.scene, begin_ns_, flight_scene(way, track.colour, begin_ns_));
  }

  void write_step(const Flown& flown, std::size_t row) {
    const flight::StepRecord& step = flown.record.steps[row];
    const Track& track = tracks_.at(flown.agent->name);
    const std::uint64_t time_ns = begin_ns_ + step.step * step_ns_;
    put(track.scene, time_ns, step_scene(world_, step, flown.agent->name, track.colour, time_ns));
    foxglove::LocationFix fix;
    const world::GeoPosition place = world_.place(step);
    fix.set_latitude(place.latitude_deg);
    fix.set_longitude(place.longitude_deg);
    fix.set_altitude(step.height_m);
    *fix.mutable_timestamp() = timestamp(time_ns);
    fix.set_frame_id(frame);
    *fix.mutable_color() = track.colour;
    put(track.location, time_ns, fix);
    put(track.step, time_ns, step_message(flown, row, time_ns));
  }

  [[nodiscard]] Step step_message(const Flown& flown, std::size_t row, std::uint64_t time_ns) const {
    const flight::StepRecord& step = flown.record.steps[row];
    Step message;
    *message.mutable_timestamp() = timestamp(time_ns);
    message.set_condition(condition_->name);
    message.set_trial(trial_);
    message.set_agent(flown.agent->name);
    message.set_step(step.step);
    message.set_action(std::string(action_name(step.action)));
    message.set_flown_by(flown.record.pilots.at(step.flown_by));
    message.set_x_m(step.x_m);
    message.set_y_m(step.y_m);
    message.set_height_m(step.height_m);
    message.set_serving_cell(step.serving_cell);
    message.set_serving_sinr_db(step.serving_sinr_db);
    message.set_qos(step.qos);
    message.set_qos_unit(std::string(experiment::qos_unit(condition_->kind)));
    message.set_reward(step.reward);
    message.set_energy_j(flown.record.step_energy_j(row, costs_));
    if (!step.introspection) return message;
    message.set_epsilon(step.introspection->epsilon);
    message.set_loss(step.introspection->loss);
    message.set_q_down(step.introspection->q_values[0]);
    message.set_q_hold(step.introspection->q_values[1]);
    message.set_q_up(step.introspection->q_values[2]);
    return message;
  }

  const store::ResultStore& results_;
  const experiment::Experiment& experiment_;
  mcap::Writer writer_;
  std::uint16_t world_channel_ = 0;
  std::map<std::string, Track> tracks_;  // by agent

  // The present world.
  const experiment::Condition* condition_ = nullptr;
  std::uint32_t trial_ = 0;
  flight::Costs costs_;
  std::uint64_t begin_ns_ = 0;
  std::uint64_t step_ns_ = 0;
  DrawnWorld world_;
  const experiment::Condition* drawn_ = nullptr;  // whose world that is
};

}  // namespace

void write_recording(const store::ResultStore& results, std::span<const FlightSummary> flights,
                     const std::filesystem::path& file) {
  FileDraft draft(file);
  Recording recording(results, flights, [&](std::string_view bytes) { draft.write(bytes); });
  while (!flights.empty()) {
    const experiment::FlightKey& first = flights.front().key;
    const auto other = std::ranges::find_if(flights, [&](const FlightSummary& flight) {
      return flight.key.condition != first.condition || flight.key.trial != first.trial;
    });
    const auto count = static_cast<std::size_t>(other - flights.begin());
    recording.write_world(flights.first(count));
    flights = flights.subspan(count);
  }
  recording.finish();
  draft.commit();
}

}  // namespace aloft::exports
