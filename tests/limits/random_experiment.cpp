#include "tests/limits/random_experiment.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <span>
#include <string>
#include <vector>

#include "common/agents/registry.hpp"
#include "common/base/limits.hpp"
#include "common/base/random.hpp"
#include "common/experiment/file_keys.hpp"
#include "common/radio/generated_world.hpp"
#include "common/radio/models/link_model.hpp"
#include "common/radio/serving_rule.hpp"

namespace aloft::test {
namespace {

using Json = nlohmann::json;

class Draw {
 public:
  explicit Draw(std::uint64_t seed) : random_(seed, 0, "random experiment") {}

  bool chance(double probability) { return random_.uniform() < probability; }
  std::uint32_t below(std::size_t n) { return random_.uniform_index(static_cast<std::uint32_t>(n)); }
  template <class T>
  T one_of(const std::vector<T>& values) {
    return values[below(values.size())];
  }
  double between(double low, double high) {
    if (chance(0.2)) return low;
    if (chance(0.2)) return high;
    if (low > 0.0 && chance(0.5)) return std::clamp(low * std::pow(high / low, random_.uniform()), low, high);
    return random_.uniform(low, high);
  }
  int whole(double low, double high) { return static_cast<int>(std::floor(between(low, high))); }

  Json value(const ParameterSpec& spec) {
    switch (spec.kind) {
      case ParameterSpec::Kind::number:
        return between(spec.minimum, spec.maximum);
      case ParameterSpec::Kind::integer:
        return whole(spec.minimum, spec.maximum);
      case ParameterSpec::Kind::flag:
        return chance(0.5);
      case ParameterSpec::Kind::choice:
        return one_of(spec.choices);
      case ParameterSpec::Kind::text:
        break;
    }
    return std::get<std::string>(spec.default_value);
  }

  /// Some parameters of a table, without those in `except`.
  Json some_of(std::span<const ParameterSpec> table, double share, const std::vector<std::string>& except = {}) {
    Json values = Json::object();
    for (const ParameterSpec& spec : table)
      if (std::find(except.begin(), except.end(), spec.name) == except.end() &&
          spec.kind != ParameterSpec::Kind::text && chance(share))
        values[spec.name] = value(spec);
    return values;
  }

 private:
  RandomStream random_;
};

/// Sets heights that mostly divide as they must. A channel model that checks its worlds has base stations of one
/// height, and holds for UAVs up to 300 m.
void put_heights(Draw& draw, bool small, const radio::LinkModelType& model, Json& world) {
  const bool limited = static_cast<bool>(model.check);
  const double base_m = limited ? model.defaults.at("base_station_height_m") : draw.between(1, 200);
  const double step_m = draw.one_of<double>({0.1, 0.5, 1, 10, 100, limited ? 50.0 : 1000.0});
  const double range_m = limited ? 250.0 : 9'000.0;
  const int levels = draw.chance(0.1) ? 0 : draw.whole(1, std::min(small ? 30.0 : 5000.0, range_m / step_m));
  const int parts = draw.one_of<int>({1, 1, 2, 5, 10});
  world["base_station_height_m"] = base_m;
  world["height_min_m"] = std::ceil(base_m) + draw.one_of<int>({0, 0, 10});
  world["height_max_m"] = world["height_min_m"].get<double>() + step_m * levels;
  world["height_step_m"] = step_m;
  world["height_resolution_m"] = step_m / parts;
}

/// Sets a route that mostly ends within the city.
void put_route(Draw& draw, bool small, const radio::LinkModelType& model, Json& world) {
  const double window_m = draw.between(100, model.check ? 2'800 : small ? 3'000 : 10'000);  // links of at most 4 km
  const int steps = draw.whole(1, small ? 30 : 10'000);
  const double length_m = draw.between(0.1 * steps, std::max(0.1 * steps, 0.95 * window_m));
  world["window_m"] = window_m;
  world["steps"] = steps;
  world["route_spacing_m"] = std::min(1000.0, length_m / steps);
  world["route_start_x_m"] = -0.5 * length_m;
  if (draw.chance(0.5)) world["route_offset_max_m"] = draw.between(0, 0.5 * window_m);
}

Json generated_world(Draw& draw, bool small) {
  const auto models = radio::link_model_types();
  const radio::LinkModelType& model = models[draw.below(models.size())];
  Json world = draw.some_of(radio::generated_world_parameters(model), draw.one_of<double>({0.05, 0.3}));
  world["propagation"] = model.name;
  const auto presets = radio::presets_with(model);
  const bool implied = std::ranges::find(presets, world.value("preset", "published")) != presets.end();
  if (implied && draw.chance(0.5)) world.erase("propagation");
  if (draw.chance(0.3)) world["serving"] = "a3";
  if (world.value("serving", "strongest") == "a3") {
    world.update(draw.some_of(radio::a3_parameters(), 0.2));
    if (draw.chance(0.7)) world.erase("qout_db");  // two drawn SINRs are often the wrong way round
  }
  put_heights(draw, small, model, world);
  put_route(draw, small, model, world);
  if (model.check) world["carrier_ghz"] = draw.between(0.7, 30);
  const double area_km2 = std::pow(world["window_m"].get<double>() / 1000.0, 2);
  const double most = small ? std::clamp(60.0 / area_km2, 0.1, 500.0) : 500.0;
  world["bs_density_per_km2"] = draw.between(std::clamp(10.0 / area_km2, 0.1, most), most);
  if (!world.contains("building_density_per_km2") || small)
    world["building_density_per_km2"] = draw.between(0, small ? 100 : 2000);
  if (draw.chance(0.7)) world.erase("cells_per_site");  // three need one of the antennas
  if (draw.chance(0.7)) {                               // otherwise more candidates than base stations are possible
    world.erase("candidates");
    world["min_base_stations"] = 6;
  }
  return world;
}

/// Base stations around 45 N, 6 W, beside the measured flight in `file`.
void write_sites(Draw& draw, std::filesystem::path file) {
  const bool with_power = draw.chance(0.5);
  const bool with_azimuth = draw.chance(0.5);
  std::ofstream csv(file.replace_extension(".sites.csv"));
  csv << "cell,latitude,longitude,antenna_height_m" << (with_power ? ",power_w" : "")
      << (with_azimuth ? ",azimuth_deg" : "") << "\n";
  for (int last = draw.whole(0, 12), site = 0; site <= last; ++site) {
    csv << fmt::format("{},{},{},{}", 2147483647 - site, draw.between(44.99, 45.01), draw.between(-6.01, -5.99),
                       draw.between(1, 200));
    if (with_power) csv << fmt::format(",{}", draw.between(0.001, 1000));
    if (with_azimuth) csv << fmt::format(",{}", draw.between(0, 360));
    csv << "\n";
  }
}

/// A measured world whose columns are mostly valid.
Json measured_world(Draw& draw, bool small, const std::filesystem::path& file) {
  const bool long_flight = !small && draw.chance(0.2);
  const int heights = draw.whole(2, long_flight ? 70 : 40);
  const int steps = long_flight ? draw.one_of<int>({16'000, 16'384, 16'385, 20'000}) : draw.whole(1, 40);
  const double spacing_m = draw.one_of<double>({1e-4, 1e-3, 0.1, 1, 10, 100});
  const double lowest_m = draw.whole(0, 9'000);
  const double most_kbps = draw.one_of<double>({1e5, 1e6, 3.2e7, 4e7, limits::quality});
  const bool with_sinr = draw.chance(0.5);
  const bool with_cell = draw.chance(0.5);
  const bool with_place = !long_flight && draw.chance(0.5);
  if (with_place) write_sites(draw, file);
  std::ofstream csv(file);
  csv << "step,height_m,throughput_kbps" << (with_sinr ? ",sinr_db" : "") << (with_cell ? ",serving_cell" : "")
      << (with_place ? ",latitude,longitude" : "") << "\n";
  for (int step = 1; step <= steps; ++step)
    for (int level = 0; level < heights; ++level) {
      csv << fmt::format("{},{},{}", step, lowest_m + spacing_m * level, draw.between(0, most_kbps));
      if (with_sinr) csv << fmt::format(",{}", draw.between(-200, 200));
      if (with_cell) csv << fmt::format(",{}", draw.one_of<int>({0, 1, 2147483647}));
      if (with_place) csv << fmt::format(",{},{}", 45.0 + 1e-4 * step, -6.0 + 1e-6 * level);
      csv << "\n";
    }
  return {{"kind", "measured"}, {"file", file.string()}};
}

/// One of this program's agents with some of its parameters; never one that trains for long. Nobody has a site map of
/// the measured worlds above.
Json agent(Draw& draw, std::size_t number, bool measured) {
  static const std::vector<std::string> slow{
      "epochs",          "hidden_width",     "hidden_layers",           "minibatch",
      "replay_capacity", "se_horizon_steps", "throughput_horizon_steps"};
  std::vector<const agents::AgentType*> types;
  for (const agents::AgentType& type : agents::agent_types())
    if (!type.foreign && !type.relay && !(measured && type.privilege == agents::Privilege::site_map))
      types.push_back(&type);
  const agents::AgentType& type = *draw.one_of(types);
  Json entry = draw.some_of(type.parameters, draw.one_of<double>({0.0, 0.3}), slow);
  if (type.name == "dqn") entry.update({{"epochs", 2}, {"hidden_width", 8}, {"minibatch", 4}, {"replay_capacity", 8}});
  entry["type"] = type.name;
  entry["name"] = fmt::format("agent-{}", number);
  return entry;
}

}  // namespace

RandomExperiment random_experiment(std::uint64_t seed, const std::filesystem::path& folder, bool small) {
  Draw draw(seed);
  RandomExperiment result{draw.some_of(experiment::file_settings(), 0.3, {"trials", "on_agent_loss"}), small};
  result.small = small || draw.chance(0.7);
  result.json["name"] = fmt::format("random-{}", seed);
  result.json["seed"] = draw.chance(0.2) ? UINT64_MAX : seed;
  result.json["trials"] = draw.whole(1, 2);
  result.json["world"] = draw.chance(0.5) ? generated_world(draw, result.small)
                                          : measured_world(draw, result.small, folder / fmt::format("{}.csv", seed));
  result.json["agents"] = Json::array();
  for (std::size_t i = 0; i < 1 + draw.below(3); ++i)
    result.json["agents"].push_back(agent(draw, i, result.json["world"].contains("file")));
  return result;
}

}  // namespace aloft::test
