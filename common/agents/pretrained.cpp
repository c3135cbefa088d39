#include <fmt/format.h>

#include <Eigen/Core>
#include <memory>
#include <nlohmann/json.hpp>

#include "common/agents/pretrained_builtin.hpp"
#include "common/agents/pretrained_model.hpp"
#include "common/agents/pretrained_state.hpp"
#include "common/agents/registry.hpp"
#include "common/agents/steering.hpp"
#include "common/agents/training_worlds.hpp"
#include "common/base/digest.hpp"
#include "common/base/error.hpp"
#include "common/base/json_text.hpp"
#include "common/base/read_file.hpp"

namespace aloft::agents {
namespace {

/// The network as it is used in flight. Sums run over the inputs in a fixed order, with a multiplication and an
/// addition each, so that every machine gets the same bits.
class FlyingNetwork {
 public:
  explicit FlyingNetwork(const PretrainedModel::Network& network) {
    const float* from = network.weights.data();
    for (const learn::LayerShape& shape : pretrained_shape(network.hidden_width).layers) {
      using RowMajor = Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
      const Eigen::Map<const RowMajor> stored(from, static_cast<Eigen::Index>(shape.outputs),
                                              static_cast<Eigen::Index>(shape.inputs + 1));
      layers_.push_back({stored.leftCols(stored.cols() - 1), stored.rightCols(1)});
      from += shape.parameters();
    }
  }

  [[nodiscard]] std::array<float, 3> values(std::span<const float, PretrainedState::inputs> inputs) const {
    Eigen::VectorXf below = Eigen::Map<const Eigen::VectorXf>(inputs.data(), PretrainedState::inputs);
    Eigen::VectorXf sums;
    for (std::size_t l = 0; l < layers_.size(); ++l) {
      sums = layers_[l].bias;
      for (Eigen::Index i = 0; i < below.size(); ++i)
        if (below[i] != 0.0F) sums += layers_[l].weights.col(i) * below[i];
      below = l + 1 < layers_.size() ? sums.cwiseMax(0.0F) : sums;
    }
    return {below[0], below[1], below[2]};
  }

 private:
  struct Layer {
    Eigen::MatrixXf weights;
    Eigen::VectorXf bias;
  };
  std::vector<Layer> layers_;
};

/// The content of a model file, ready for use.
struct LoadedModel {
  std::uint64_t id;  // of the file's bytes
  FlyingNetwork spectral_efficiency;
  FlyingNetwork throughput;
};

std::string read_model(const std::string& path) {
  try {
    return aloft::read_file(path);
  } catch (const InputError& error) {
    throw InputError("{}; give the agent's parameter 'model' a model file, or leave it empty for the built-in one",
                     error.what());
  }
}

LoadedModel load(std::string_view bytes, std::string_view where) {
  const PretrainedModel model = parse_pretrained_model(bytes, where);
  return {sha256_id(bytes), FlyingNetwork(model.spectral_efficiency), FlyingNetwork(model.throughput)};
}

/// The built-in model is loaded once per process, because an agent is made for every flight.
std::shared_ptr<const LoadedModel> model_of(const std::string& path, const std::string& sha256) {
  if (!path.empty()) {
    const std::string bytes = read_model(path);
    check_unchanged(path, bytes, sha256, "use the original file on every machine");
    return std::make_shared<const LoadedModel>(load(bytes, path));
  }
  static const auto builtin = std::make_shared<const LoadedModel>(load(builtin_model(), "the built-in model"));
  return builtin;
}

/// Flies the preferred action of a pre-trained network (docs/learners.md), which does not change in flight.
class Pretrained final : public SteeringAgent {
 public:
  explicit Pretrained(const Parameters& parameters)
      : SteeringAgent("pretrained", parameters),
        model_(model_of(parameters.text("model"), parameters.text("model_sha256"))) {}

  void begin(const FlightInfo& flight) override {
    SteeringAgent::begin(flight);
    state_ = PretrainedState(flight.qos, level_count(flight));
  }

  void observe(const Observation& observation) override {
    SteeringAgent::observe(observation);
    state_.observe(pretrained_report(flight().qos, level(), observation));
  }

  Command act() override {
    std::array<float, PretrainedState::inputs> inputs{};
    state_.encode(inputs);
    const bool throughput = flight().qos == QosKind::throughput;
    const auto values = (throughput ? model_->throughput : model_->spectral_efficiency).values(inputs);
    constexpr std::array<Action, 3> actions = {Action::down, Action::hold, Action::up};
    Introspection thought;
    for (std::size_t i = 0; i < values.size(); ++i) thought.q_values[i] = static_cast<double>(values[i]);
    return {actions[preferred_action(values)], 0.0, thought};
  }

 private:
  void save(StateWriter& writer) const override {
    const PretrainedState::Memory& memory = state_.memory();
    writer.put_integer("model", model_->id);
    std::vector<float> level_values;
    std::vector<std::int64_t> level_steps;
    for (const auto& seen : memory.levels) {
      level_values.insert(level_values.end(), {seen.qos, seen.second_se});
      level_steps.push_back(seen.step);
    }
    std::vector<float> past;
    for (const auto& step : memory.past) past.insert(past.end(), {step.qos, step.level_change});
    writer.put("levels", std::span<const float>(level_values));
    writer.put("level_steps", std::span<const std::int64_t>(level_steps));
    writer.put("past", std::span<const float>(past));
    writer.put("se", std::span<const float>(memory.se));
    writer.put_integer("reports", static_cast<std::uint64_t>(std::int64_t{memory.steps} + 1));
    writer.put_integer("level", memory.level);
    writer.put_number("qos_sum", memory.qos_sum);
    writer.put_number("qos_max", static_cast<double>(memory.qos_max));
  }

  void restore(const StateReader& reader) override {
    if (reader.integer("model") != model_->id) reader.refuse("it was saved by an agent with another model");
    const auto level_steps = reader.integers("level_steps");
    const std::size_t levels = flight().steps == 0 ? level_steps.size() : level_count(flight());
    if (level_steps.size() != levels) reader.refuse("its heights do not fit its flight");
    PretrainedState::Memory memory;
    memory.levels.resize(levels);
    std::vector<float> level_values(2 * levels);
    reader.get("levels", std::span(level_values));
    memory.steps = static_cast<std::int32_t>(reader.integer("reports")) - 1;
    for (std::size_t k = 0; k < levels; ++k) {
      if (level_steps[k] < -1 || level_steps[k] > memory.steps) reader.refuse("a visit lies in the future");
      memory.levels[k] = {level_values[2 * k], level_values[2 * k + 1], static_cast<std::int32_t>(level_steps[k])};
    }
    std::array<float, 2 * PretrainedState::history> past{};
    reader.get("past", std::span<float>(past));
    for (std::size_t i = 0; i < memory.past.size(); ++i) memory.past[i] = {past[2 * i], past[2 * i + 1]};
    reader.get("se", std::span<float>(memory.se));
    memory.level = static_cast<std::uint32_t>(reader.integer("level"));
    if (levels > 0 && memory.level >= levels) reader.refuse("its height is none of the flight's");
    memory.qos_sum = reader.number("qos_sum");
    memory.qos_max = static_cast<float>(reader.number("qos_max"));
    state_ = PretrainedState(flight().qos, static_cast<std::uint32_t>(levels));
    state_.restore(std::move(memory));
  }

  std::shared_ptr<const LoadedModel> model_;
  PretrainedState state_;
};

nlohmann::json provenance() {
  const PretrainedModel model = parse_pretrained_model(builtin_model(), "the built-in model");
  const TrainingWorlds& worlds = training_worlds;
  return {{"model", "data/models/pretrained.pb"},
          {"sha256", builtin_model_sha256()},
          {"trained_on",
           fmt::format("preset published, {:g} to {:g} base stations and {:g} buildings per km2; made-up throughput of "
                       "{} to {} heights and {} to {} steps",
                       worlds.bs_density_min_per_km2, worlds.bs_density_max_per_km2, worlds.building_density_per_km2,
                       worlds.measured_levels_min, worlds.measured_levels_max, worlds.measured_steps_min,
                       worlds.measured_steps_max)},
          {"made_by", "aloft train pretrained --config data/models/pretrained.json"},
          {"training_config", nlohmann::json(parse_json(model.training_config, "the training's configuration"))}};
}

const bool pretrained_registered = register_agent(
    {.name = "pretrained",
     .description = "Flies by a network trained beforehand on generated worlds, frozen in flight.",
     .trained_beforehand = true,
     .host = Host::learning_agent,
     .looks = {{"pretrained", default_rank, "#ba3c87", "#db6d9c", {12, 4}}},
     .file_parameter = "model",
     .parameters = {text_parameter("model", "", "Model file of 'aloft train pretrained'; empty: the built-in model."),
                    text_parameter("model_sha256", "",
                                   "SHA-256 that the model file must have; filled in when an experiment is resolved.")},
     .make = [](const Parameters& parameters) { return std::make_unique<Pretrained>(parameters); },
     .provenance = provenance});

}  // namespace
}  // namespace aloft::agents
