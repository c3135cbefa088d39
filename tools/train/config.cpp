#include "tools/train/config.hpp"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "common/base/error.hpp"
#include "common/base/json_text.hpp"
#include "common/base/plain_text.hpp"
#include "common/base/read_file.hpp"

namespace aloft::train {
namespace {

std::vector<ParameterSpec> table_of(radio::QosKind kind) {
  const bool throughput = kind == radio::QosKind::throughput;
  return {
      integer_parameter("seed", throughput ? 7'002 : 7'001, 0, 1e9, "Of worlds, flights and weights."),
      integer_parameter("worlds", 1'500, 1, 100'000,
                        throughput ? "Random throughput fields."
                                   : "Cities, shared out to 1, 1.7, 2.5, 3.5 and 5 base stations per km2 in turn."),
      integer_parameter("validation_worlds", 300, 1, 10'000, "Held out; they choose the round that is kept."),
      integer_parameter("rounds", 6, 0, 100, "Rounds of policy iteration."),
      integer_parameter("hidden_width", 192, 1, 256, "Units of each of the two hidden layers."),
      number_parameter("informed_discount", 0.9, 0, 1, "Of the best feasible flight that the first network imitates."),
      number_parameter("rollout_discount", 0.94, 0, 1, "Per step of a rollout."),
      integer_parameter("rollout_steps", 20, 1, 1'000, "Steps of a rollout."),
      number_parameter("random_share", 0.04, 0, 1, "Probability of a random detour at each step of a visiting flight."),
      number_parameter("state_share", throughput ? 0.6 : 1.0, 0.001, 1, "Share of the visited states rolled out."),
      integer_parameter("reused_rounds", 3, 1, 100, "Rounds, the latest included, whose samples are fitted."),
      integer_parameter("updates", 128'000, 1, 1e9, "Adam steps per round, each on 16 samples."),
      number_parameter("learning_rate", 5e-4, 1e-7, 1, "At the start of a round; falls to zero along a cosine."),
  };
}

}  // namespace

const std::vector<ParameterSpec>& stage_parameters(radio::QosKind kind) {
  static const auto spectral_efficiency = table_of(radio::QosKind::spectral_efficiency);
  static const auto throughput = table_of(radio::QosKind::throughput);
  return kind == radio::QosKind::throughput ? throughput : spectral_efficiency;
}

nlohmann::json Config::canonical() const {
  return {{"spectral_efficiency", spectral_efficiency.to_json()}, {"throughput", throughput.to_json()}};
}

Config read_config(const std::filesystem::path& file) {
  const nlohmann::json json = parse_json(read_file(file), file.string());
  if (!json.is_object()) throw InputError("{}: must be a JSON object", file.string());
  for (const auto& [key, value] : json.items())
    if (key != "spectral_efficiency" && key != "throughput")
      throw InputError("{}: unknown key \"{}\"; allowed: spectral_efficiency, throughput", file.string(), excerpt(key));
  const auto stage = [&](const char* key, radio::QosKind kind) {
    return Parameters(stage_parameters(kind), json.value(key, nlohmann::json::object()),
                      fmt::format("{}: {}", file.string(), key));
  };
  return {stage("spectral_efficiency", radio::QosKind::spectral_efficiency),
          stage("throughput", radio::QosKind::throughput)};
}

}  // namespace aloft::train
