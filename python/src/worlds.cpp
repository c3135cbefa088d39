#include "python/src/worlds.hpp"

#include <nlohmann/json.hpp>
#include <utility>

#include "common/base/error.hpp"
#include "common/base/json_text.hpp"
#include "common/world/city.hpp"

namespace aloft::python {
namespace {

using OrderedJson = nlohmann::ordered_json;

/// What Python may see stands in the experiment as agents that may see it, so that the checks of an experiment hold
/// here, too.
OrderedJson agents_entry(const Choices& choices) {
  OrderedJson entry = OrderedJson::array({{{"type", "external"}, {"name", "python"}}});
  for (const agents::Privilege privilege : choices.privileges) {
    const std::string tier(agents::privilege_tier(privilege).name);
    entry.push_back({{"type", "external"}, {"name", "python-" + tier}, {"privilege", tier}});
  }
  return entry;
}

experiment::Experiment parse_world(std::string_view world, const Choices& choices) {
  OrderedJson document{{"name", "python"}, {"trials", 1}, {"agents", agents_entry(choices)}};
  document["world"] = parse_json(world, "world");
  if (choices.energy_weight) document["energy_weight"] = *choices.energy_weight;
  if (choices.handover_cost) document["handover_cost"] = *choices.handover_cost;
  return experiment::parse(document.dump(-1, ' ', false, OrderedJson::error_handler_t::replace), "aloft", {});
}

experiment::Experiment load_file(const std::filesystem::path& file, const Choices& choices) {
  experiment::Overrides overrides;
  overrides.set.push_back("agents=" + agents_entry(choices).dump());
  if (choices.energy_weight) overrides.set.push_back("energy_weight=" + OrderedJson(*choices.energy_weight).dump());
  if (choices.handover_cost) overrides.set.push_back("handover_cost=" + OrderedJson(*choices.handover_cost).dump());
  return experiment::load(file, overrides);
}

}  // namespace

Worlds::Worlds(std::string_view world, const Choices& choices) : Worlds(parse_world(world, choices)) {}

Worlds::Worlds(const std::filesystem::path& experiment_file, const Choices& choices)
    : Worlds(load_file(experiment_file, choices)) {}

Worlds::Worlds(experiment::Experiment experiment) : experiment_(std::move(experiment)) {
  for (const experiment::Condition& condition : experiment_.conditions)
    measured_.push_back(condition.kind == experiment::WorldKind::measured ? std::make_unique<Measured>() : nullptr);
}

flight::Costs Worlds::costs(std::uint32_t condition) const {
  return experiment_.costs_in(conditions().at(condition));
}

bool Worlds::measured(std::uint32_t condition) const {
  return measured_.at(condition) != nullptr;
}

const experiment::TrialWorld& Worlds::measured_world(std::uint32_t condition) const {
  Measured& measured = *measured_.at(condition);
  const std::scoped_lock lock(measured.mutex);
  if (!measured.world)
    measured.world =
        std::make_unique<experiment::TrialWorld>(experiment::read_measured_world(conditions().at(condition)));
  return *measured.world;
}

experiment::TrialWorld Worlds::world(std::uint32_t condition, std::uint64_t seed, std::uint32_t trial) const {
  if (measured(condition)) return measured_world(condition);
  return world::generate_city(conditions().at(condition).world, seed, trial);
}

std::unique_ptr<radio::SignalMap> Worlds::map(std::uint32_t condition, std::uint64_t seed, std::uint32_t trial) const {
  const experiment::Condition& at = conditions().at(condition);
  if (measured(condition)) return experiment::make_signal_map(at, seed, trial, measured_world(condition));
  return experiment::make_signal_map(at, seed, trial, world(condition, seed, trial));
}

}  // namespace aloft::python
