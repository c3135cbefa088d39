#include "common/bus/validate.hpp"

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <span>
#include <vector>

#include "common/base/limits.hpp"
#include "common/base/process_name.hpp"

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

/// A time, a rate: finite and not negative.
bool amount(double value) noexcept {
  return within(value, 0.0, 1e12);
}
bool finite(double value) noexcept {
  return std::isfinite(value);
}

bool all(std::span<const double> values, bool (*good)(double) noexcept) noexcept {
  return std::all_of(values.begin(), values.end(), good);
}

template <class Enum>
bool known(Enum value, Enum last) noexcept {
  return static_cast<std::uint32_t>(value) <= static_cast<std::uint32_t>(last);
}

template <class Text>
bool given(const Text& text) noexcept {
  return !wire::view(text).empty();
}
bool sha256(const wire::Name& digest) noexcept {
  return wire::view(digest).size() == 64;
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

/// What an operator knew of a measured flight.
const char* measured_sites_error(const wire::MeasuredFlight& flight) noexcept {
  if (flight.sites().empty()) return "measured.sites is empty, but route is not";
  if (flight.sites().size() > limits::base_stations) return "measured.sites too long";
  if (flight.route().size() != flight.steps()) return "measured.route is not steps long";
  for (const wire::Position& position : flight.route())
    if (!distance(position.x_m()) || !distance(position.y_m())) return "measured.route out of range";
  for (const wire::MeasuredSite& site : flight.sites()) {
    if (site.cell() < 0) return "measured.sites: cell out of range";
    if (!distance(site.x_m()) || !distance(site.y_m())) return "measured.sites: position out of range";
    if (!within(site.azimuth_deg(), -360.0, 360.0)) return "measured.sites: azimuth_deg out of range";
  }
  if (!height(flight.antenna_height_m())) return "measured.antenna_height_m out of range";
  if (!amount(flight.power_w())) return "measured.power_w out of range";
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
  return flight.sites().empty() && flight.route().empty() ? nullptr : measured_sites_error(flight);
}

const char* agents_error(const std::vector<wire::AgentNews>& agents) noexcept {
  for (const wire::AgentNews& agent : agents) {
    if (!known(agent.state(), wire::AGENT_STOPPED)) return "unknown state of an agent";
    if (!amount(agent.silent_s())) return "silent_s of an agent out of range";
  }
  return nullptr;
}

const char* site_map_error(const wire::SiteMap& map) noexcept {
  for (const wire::RoutePoint& point : map.route())
    if (!distance(point.x_m()) || !distance(point.y_m())) return "route out of range";
  for (const wire::Site& site : map.sites()) {
    if (site.cell() < 0) return "cell of a site out of range";  // those of measured flights can be large
    if (!distance(site.x_m()) || !distance(site.y_m())) return "position of a site out of range";
    if (!height(site.antenna_height_m())) return "antenna_height_m of a site out of range";
    if (!amount(site.power_w())) return "power_w of a site out of range";
    if (!known(site.antenna(), wire::ANTENNA_SECTOR)) return "unknown antenna of a site";
    if (!within(site.azimuth_deg(), -360.0, 360.0)) return "azimuth_deg of a site out of range";
  }
  return nullptr;
}

/// One thing that must hold for a sample.
struct Limit {
  const char* error;  // null: it holds

  Limit(bool holds, const char* otherwise) noexcept : error(holds ? nullptr : otherwise) {}
  Limit(const char* wrong) noexcept : error(wrong) {}  // NOLINT: as it is called in topics.def
};

const char* first_error(std::initializer_list<Limit> wanted) noexcept {
  for (const Limit& limit : wanted)
    if (limit.error != nullptr) return limit.error;
  return nullptr;
}

}  // namespace

#define ALOFT_TOPIC(type, settings, ...)               \
  const char* validate(const wire::type& s) noexcept { \
    return first_error({__VA_ARGS__});                 \
  }
#include "common/bus/topics.def"

}  // namespace aloft::bus
