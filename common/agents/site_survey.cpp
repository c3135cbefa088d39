#include "common/agents/site_survey.hpp"

#include <algorithm>
#include <cstdint>
#include <limits>
#include <nlohmann/json.hpp>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

#include "common/base/json_text.hpp"
#include "common/base/limits.hpp"
#include "common/radio/generated_world.hpp"
#include "common/world/site_map.hpp"

namespace aloft::agents {

SiteSurvey survey_from(const SiteMap& first) {
  if (!first.radio) throw std::logic_error("an update came before the site map");
  return {*first.radio, first.known};
}

namespace {

/// NaN is not within.
bool within(double value, double low, double high) {
  return value >= low && value <= high;
}

/// Four numbers each: cell, x, y and azimuth.
void check_sites(std::span<const double> numbers, const StateReader& reader) {
  for (std::size_t i = 0; i < numbers.size(); i += 4)
    if (!within(numbers[i], -1.0, std::numeric_limits<std::int32_t>::max()) ||
        !within(numbers[i + 1], -limits::distance_m, limits::distance_m) ||
        !within(numbers[i + 2], -limits::distance_m, limits::distance_m) || !within(numbers[i + 3], -360.0, 360.0))
      reader.refuse("it has an impossible site");
}

/// As worlds may have them.
void check_errors(const world::SiteMap& map, const StateReader& reader) {
  const auto possible = [](const char* name, double value) {
    const auto& table = world::site_map_parameters();
    const auto spec = std::ranges::find(table, name, &ParameterSpec::name);
    return within(value, spec->minimum, spec->maximum);
  };
  if (!possible("site_map_error_m", map.position_error_m) || !possible("site_map_missing", map.missing) ||
      map.route_points > limits::steps)
    reader.refuse("the errors of its site map are impossible");
}

}  // namespace

void save_survey(StateWriter& writer, const std::optional<SiteSurvey>& survey) {
  writer.put_integer("surveyed", survey ? 1 : 0);
  const std::string json = survey ? survey->radio.to_json().dump() : "";
  const std::vector<std::int64_t> radio(json.begin(), json.end());
  const world::SiteMap map = survey ? survey->map : world::SiteMap{};
  std::vector<double> sites;
  for (const world::Site& site : map.sites)
    for (const double value : {static_cast<double>(site.cell), site.position.x_m, site.position.y_m, site.azimuth_deg})
      sites.push_back(value);
  writer.put("radio", std::span<const std::int64_t>(radio));
  writer.put("sites", std::span<const double>(sites));
  writer.put_number("position_error_m", map.position_error_m);
  writer.put_number("missing", map.missing);
  writer.put_integer("route_points", map.route_points);
}

std::optional<SiteSurvey> restore_survey(const StateReader& reader) {
  if (reader.integer("surveyed") == 0) return std::nullopt;
  std::string radio;
  for (const std::int64_t byte : reader.integers("radio")) radio.push_back(static_cast<char>(byte));
  const auto sites = reader.doubles("sites");
  if (sites.size() % 4 != 0) reader.refuse("its sites are cut");
  check_sites(sites, reader);
  world::SiteMap map;
  for (std::size_t i = 0; i < sites.size(); i += 4)
    map.sites.push_back({static_cast<std::int32_t>(sites[i]), {sites[i + 1], sites[i + 2]}, sites[i + 3]});
  map.position_error_m = reader.number("position_error_m");
  map.missing = reader.number("missing");
  map.route_points = static_cast<std::uint32_t>(reader.integer("route_points"));
  check_errors(map, reader);
  try {
    return SiteSurvey{radio::resolve_generated_world(parse_json(radio, "radio"), "radio"), std::move(map)};
  } catch (const std::exception& error) {
    reader.refuse(error.what());
  }
}

}  // namespace aloft::agents
