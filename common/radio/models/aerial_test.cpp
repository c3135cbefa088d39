// The channel models of 3GPP TR 36.777 in generated worlds. The formulas themselves: aerial_link_test.cpp.
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <functional>
#include <nlohmann/json.hpp>
#include <numbers>

#include "common/base/error.hpp"
#include "common/radio/aerial_link.hpp"
#include "common/radio/expected_field.hpp"
#include "common/radio/generated_map.hpp"
#include "common/radio/generated_world.hpp"
#include "common/radio/inspect.hpp"
#include "common/radio/link_budget.hpp"
#include "common/radio/scene.hpp"
#include "common/radio/testing/link_model_conformance.hpp"
#include "common/world/city.hpp"

using namespace aloft;
using Catch::Contains;
using nlohmann::json;
using radio::AerialLink;

namespace {

Parameters world_of(std::string_view model, json given = json::object()) {
  given["propagation"] = model;
  return radio::resolve_generated_world(given, "world");
}

/// Stations on a circle around (0, 0), as many as the stations of 10,000 links in 100 trials.
world::City circle(const Parameters& world, double radius_m) {
  constexpr int stations = 100;
  world::City city;
  city.window_m = world.number("window_m");
  city.base_station_height_m = world.number("base_station_height_m");
  for (int k = 0; k < stations; ++k) {
    const double angle = 2.0 * std::numbers::pi * k / stations;
    city.base_stations.push_back({radius_m * std::cos(angle), radius_m * std::sin(angle)});
  }
  return city;
}

std::string error_of(const json& given) {
  try {
    static_cast<void>(radio::resolve_generated_world(given, "world"));
  } catch (const InputError& error) {
    return error.what();
  }
  return "accepted";
}

}  // namespace

TEST_CASE("the models of TR 36.777 are channel models") {
  for (const auto& model : radio::aerial_scenarios) {
    radio::check_link_model(model.word);
    radio::check_link_model(model.word, {{"carrier_ghz", 28}});
    radio::check_link_model(model.word, {{"blend_m", 20}});
    radio::check_link_model(model.word, {{"cells_per_site", "three"}, {"bs_antenna", "3gpp"}});
  }
}

TEST_CASE("gains of TR 36.777 are its path loss, relative to free space at 1 m") {
  for (const auto& model : radio::aerial_scenarios) {
    const Parameters world = world_of(model.word, {{"carrier_ghz", 5}});
    const double base_m = world.number("base_station_height_m");
    for (const double distance_m : {0.0, 60.0, 400.0, 2500.0}) {
      const world::City city = circle(world, distance_m);
      const auto made = radio::link_model_type(model.word).make(world, city, 1, 0);
      for (const double height_m : {base_m, 22.5, 22.6, 100.0, 300.0}) {
        if (height_m < base_m) continue;
        const AerialLink link{model.meaning, 5.0, distance_m, height_m};
        for (const bool line_of_sight : {false, true}) {
          INFO(model.word << ", " << distance_m << " m, height " << height_m << " m, " << line_of_sight);
          double gain = 0.0;
          double deviation_db = 0.0;
          made->mean_gain_row({{}, 0, distance_m}, line_of_sight, std::span(&height_m, 1), &gain);
          made->shadowing_row({{}, 0, distance_m}, line_of_sight, std::span(&height_m, 1), &deviation_db);
          CHECK(-10.0 * std::log10(gain * radio::near_field_gain(5e9)) ==
                Approx(radio::path_loss_db(link, line_of_sight)).margin(1e-9));
          CHECK(deviation_db == Approx(radio::shadowing_deviation_db(link, line_of_sight)).margin(1e-12));
        }
      }
    }
  }
}

TEST_CASE("blend_m is a parameter of the aerial models alone, and no step changes no id") {
  CHECK_FALSE(world_of("uma-av").to_json().contains("blend_m"));
  CHECK(world_of("uma-av", {{"blend_m", 5}}).to_json().at("blend_m") == 5);
  CHECK_THAT(error_of({{"blend_m", 5}}), Contains("world.blend_m: unknown key"));
  CHECK_THAT(error_of({{"propagation", "uma-av"}, {"blend_m", 21}}), Contains("world.blend_m") && Contains("20"));
}

TEST_CASE("the share of links with line of sight is the probability of TR 36.777") {
  struct Case {
    std::string_view model;
    double height_m;
    double distance_m;
  };
  for (const Case& at : {Case{"uma-av", 30, 500}, Case{"uma-av", 100, 2000}, Case{"umi-av", 22, 60},
                         Case{"umi-av", 50, 500}, Case{"umi-av", 300, 1500}, Case{"rma-av", 38, 2000}}) {
    const auto& scenario = *std::ranges::find(radio::aerial_scenarios, at.model, &Choice<radio::AerialScenario>::word);
    const double expected = radio::line_of_sight_probability({scenario.meaning, 2.0, at.distance_m, at.height_m});
    const Parameters world = world_of(at.model);
    const world::City city = circle(world, at.distance_m);
    int visible = 0;
    for (std::uint32_t trial = 0; trial < 100; ++trial) {
      const auto model = radio::link_model_type(at.model).make(world, city, 1, trial);
      for (std::uint32_t k = 0; k < city.base_stations.size(); ++k)
        if (model->blocking_height_m({{}, k, at.distance_m}) <= at.height_m) ++visible;
    }
    INFO(at.model << ", height " << at.height_m << " m, " << at.distance_m << " m: " << visible << " of 10000");
    CHECK(std::fabs(visible / 1e4 - expected) < 2.576 * std::sqrt(expected * (1.0 - expected) / 1e4));  // 99 %
  }
}

TEST_CASE("line of sight at 100 m and above it, as the table has it") {
  const Parameters world = world_of("uma-av");
  const world::City city = circle(world, 2000.0);
  const auto model = radio::link_model_type("uma-av").make(world, city, 1, 0);
  bool any_blocked_at_100_m = false;
  for (std::uint32_t k = 0; k < 100; ++k) {
    const double blocking_m = model->blocking_height_m({{}, k, 2000.0});
    any_blocked_at_100_m = any_blocked_at_100_m || blocking_m > 100.0;
    CHECK(blocking_m <= std::nextafter(100.0, 101.0));
  }
  CHECK(any_blocked_at_100_m);
}

TEST_CASE("shadowing in a scene has the standard deviations and correlation distances of the standard") {
  struct Case {
    std::string_view model;
    bool line_of_sight;
    double deviation_db;  // at 60 m
    double correlation_distance_m;
  };
  for (const Case& at : {Case{"uma-av", true, 4.64 * std::exp(-0.396), 37}, Case{"uma-av", false, 6, 50},
                         Case{"umi-av", true, 5.0 * std::exp(-0.6), 10}, Case{"umi-av", false, 8, 13},
                         Case{"rma-av", true, 4.2 * std::exp(-0.276), 37}, Case{"rma-av", false, 6, 120}}) {
    const Parameters world = world_of(at.model);
    const world::City city = circle(world, 1000.0);
    double square = 0.0;
    double product = 0.0;
    for (std::uint32_t trial = 0; trial < 100; ++trial) {
      const radio::Scene scene(world, city, 1, trial);
      for (std::uint32_t k = 0; k < city.base_stations.size(); ++k) {
        const double here_db = scene.shadowing_db({{}, k, 1000.0}, at.line_of_sight, 60.0);
        const double there_db =
            scene.shadowing_db({{0.0, at.correlation_distance_m}, k, 1000.0}, at.line_of_sight, 60.0);
        square += here_db * here_db / 1e4;
        product += here_db * there_db / 1e4;
      }
    }
    INFO(at.model << (at.line_of_sight ? " with" : " without") << " line of sight");
    CHECK(std::sqrt(square) == Approx(at.deviation_db).epsilon(0.03));
    CHECK(product / square == Approx(std::exp(-1.0)).margin(0.05));
  }
}

TEST_CASE("a world of TR 36.777 is the sum of its links") {
  const json given{{"uav_antenna", "omnidirectional"}, {"fading", "none"}, {"bs_density_per_km2", 1}};
  for (const auto& model : radio::aerial_scenarios) {
    const Parameters world = world_of(model.word, given);
    const world::City city = world::generate_city(world, 5, 0);
    const auto map = radio::make_generated_map(world, city, 5, 0);
    const auto spots = radio::make_generated_map(world, city, 5, 0);
    int blocked = 0;
    for (std::uint32_t point = 0; point <= 100; point += 25) {
      const auto& column = map->column(point, map->advance(point, {}, -1));
      for (std::uint32_t i = 0; i < column.size(); i += 10) {
        const double height_m = map->heights().height_m(i);
        const radio::Explanation explained = radio::explain(world, city, 5, 0, point, height_m);
        std::vector<double> power_w;
        double sum_w = 0.0;
        for (const radio::StationExplanation& station : explained.stations) {
          const AerialLink link{model.meaning, 2.0, station.distance_m, height_m};
          const double rise_m = height_m - city.base_station_height_m;
          const double sine = rise_m / std::hypot(station.distance_m, rise_m);
          const double loss_db = radio::path_loss_db(link, station.line_of_sight) + station.shadowing_db;
          power_w.push_back(40.0 * radio::array_gain(sine * sine) * std::pow(10.0, -0.1 * loss_db));
          CHECK(station.received_power_w == Approx(power_w.back()).epsilon(1e-9));
          CHECK(station.line_of_sight == (station.blocking_height_m <= height_m));
          sum_w += power_w.back();
          if (!station.line_of_sight) ++blocked;
        }
        const double strongest_w = std::ranges::max(power_w);
        const double sinr = strongest_w / (radio::noise_power_w(20e6, 10.0) + sum_w - strongest_w);
        INFO(model.word << ", point " << point << ", height " << height_m << " m");
        CHECK(column[i].qos == Approx(std::log2(1.0 + sinr)).epsilon(1e-9));
        const radio::Reading spot = spots->reading(point, explained.position, i);
        CHECK(spot.qos == column[i].qos);
        CHECK(spot.serving_cell == column[i].serving_cell);
        CHECK(spot.neighbour_sinr_db == column[i].neighbour_sinr_db);
      }
    }
    CHECK(blocked > 0);
  }
}

TEST_CASE("worlds of TR 36.777 have its base stations, and what it does not cover is refused") {
  const Parameters urban = world_of("uma-av");
  CHECK(urban.number("base_station_height_m") == 25.0);
  CHECK(urban.number("carrier_ghz") == 2.0);
  CHECK(world_of("umi-av").number("base_station_height_m") == 10.0);
  CHECK(world_of("rma-av").number("base_station_height_m") == 35.0);
  CHECK(radio::resolve_generated_world(urban.to_json(), "world").to_json() == urban.to_json());
  CHECK(world_of("rma-av", {{"carrier_ghz", 0.7}}).number("carrier_ghz") == 0.7);

  const auto refused = [](const char* model, const char* key, double value) {
    return error_of({{"propagation", model}, {key, value}});
  };
  CHECK_THAT(refused("uma-av", "base_station_height_m", 30), Contains("world.base_station_height_m: 30 is not the 25"));
  CHECK_THAT(refused("uma-av", "height_max_m", 310), Contains("world.height_max_m: 310") && Contains("300 m"));
  CHECK_THAT(refused("uma-av", "carrier_ghz", 0.5), Contains("world.carrier_ghz: 0.5") && Contains("0.7 to 100 GHz"));
  CHECK_THAT(refused("rma-av", "carrier_ghz", 60), Contains("world.carrier_ghz: 60") && Contains("0.7 to 30 GHz"));
  CHECK_THAT(refused("umi-av", "window_m", 6000), Contains("world.window_m: links up to 46") && Contains("4000 m"));
  CHECK(refused("rma-av", "window_m", 6000) == "accepted");
  CHECK_THAT(refused("uma-av", "los_ray", 1), Contains("world.los_ray"));
  CHECK_THAT(error_of({{"preset", "3gpp-uma"}, {"los_ray", "geometric"}}), Contains("world.los_ray: unknown key"));
}

TEST_CASE("spectral efficiency ends where a world's highest modulation does, SINR does not") {
  const json near{{"propagation", "uma-av"}, {"bs_density_per_km2", 1}, {"fading", "none"}};
  json capped = near;
  capped["spectral_efficiency_max"] = 7.4;
  const Parameters world = radio::resolve_generated_world(near, "world");
  const Parameters limited = radio::resolve_generated_world(capped, "world");
  const world::City city = world::generate_city(world, 5, 0);
  const auto map = radio::make_generated_map(world, city, 5, 0);
  const auto limited_map = radio::make_generated_map(limited, city, 5, 0);
  const auto limited_spots = radio::make_generated_map(limited, city, 5, 0);
  int reached = 0;
  for (std::uint32_t point = 0; point <= 100; point += 10) {
    const world::Position place = map->advance(point, {}, -1);
    const auto& free = map->column(point, place);
    const auto& column = limited_map->column(point, place);
    for (std::uint32_t i = 0; i < free.size(); i += 50) {
      CHECK(column[i].qos == std::min(free[i].qos, 7.4));
      CHECK(column[i].serving_sinr_db == free[i].serving_sinr_db);
      CHECK(limited_spots->reading(point, place, i).qos == column[i].qos);
      if (free[i].qos > 7.4) ++reached;
    }
  }
  CHECK(reached > 0);
}

TEST_CASE("the cells of a site share line of sight and shadowing, and differ by their azimuths") {
  const Parameters world = radio::resolve_generated_world({{"preset", "3gpp-uma"}}, "world");
  const world::City city = world::generate_city(world, 5, 0);
  const auto map = radio::make_generated_map(world, city, 5, 0);
  const auto spots = radio::make_generated_map(world, city, 5, 0);
  for (const std::uint32_t point : {0U, 50U}) {
    const auto& column = map->column(point, map->advance(point, {}, -1));
    for (const double height_m : {40.0, 90.0, 250.0}) {
      const radio::Explanation explained = radio::explain(world, city, 5, 0, point, height_m);
      for (std::size_t k = 0; k < explained.stations.size(); ++k) {
        const radio::StationExplanation& cell = explained.stations[k];
        const radio::StationExplanation& first = explained.stations[k - k % 3];
        CHECK(cell.blocking_height_m == first.blocking_height_m);
        CHECK(cell.shadowing_db == first.shadowing_db);
        // Element, path loss and shadowing by hand; the UAV's azimuth, seen from the cell, is the opposite one.
        double off_deg = std::fabs(cell.azimuth_deg + 180.0 - (30.0 + 120.0 * static_cast<double>(k % 3)));
        off_deg = std::fmod(off_deg, 360.0);
        off_deg = std::min(off_deg, 360.0 - off_deg);
        const double elevation_deg = std::atan2(height_m - 25.0, cell.distance_m) * (180.0 / std::numbers::pi);
        const auto plane_db = [](double deg) { return std::min(12.0 * (deg / 65.0) * (deg / 65.0), 30.0); };
        const double antenna_db = 8.0 - std::min(plane_db(off_deg) + plane_db(elevation_deg + 10.0), 30.0);
        const double loss_db =
            radio::path_loss_db({radio::AerialScenario::uma, 2.0, cell.distance_m, height_m}, cell.line_of_sight) +
            cell.shadowing_db;
        const double power_w = world.number("tx_power_w") * radio::beam_gain(std::numbers::pi / 4.0) *
                               std::pow(10.0, 0.1 * (antenna_db - loss_db));
        CHECK(cell.received_power_w == Approx(power_w).epsilon(1e-9));
      }
      const auto i = static_cast<std::uint32_t>(height_m - 40.0);
      CHECK(column[i].qos == explained.spectral_efficiency);
      CHECK(spots->reading(point, explained.position, i).qos == column[i].qos);
    }
  }
}

TEST_CASE("what is to be expected by a site map is line of sight and the mean path loss") {
  for (const auto& model : radio::aerial_scenarios) {
    const Parameters world = world_of(model.word, {{"uav_antenna", "omnidirectional"}, {"fading", "none"}});
    const world::City city = world::generate_city(world, 5, 0);
    const auto map = radio::make_generated_map(world, city, 5, 0);
    radio::ExpectedField field(world, map->survey()->map.sites);
    std::vector<double> efficiency(field.levels());
    const world::Position uav{100.0, -10.0};
    field.column(uav, efficiency.data());
    for (const std::uint32_t level : {0U, 8U, 20U}) {
      const double height_m = 40.0 + 10.0 * level;
      const double rise_m = height_m - city.base_station_height_m;
      std::vector<double> power_w;
      double sum_w = radio::noise_power_w(20e6, 10.0);
      for (const world::Position& station : city.base_stations) {
        const double distance_m = std::hypot(station.x_m - uav.x_m, station.y_m - uav.y_m);
        const double sine = rise_m / std::hypot(distance_m, rise_m);
        const double loss_db = radio::path_loss_db({model.meaning, 2.0, distance_m, height_m}, true);
        power_w.push_back(40.0 * radio::array_gain(sine * sine) * std::pow(10.0, -0.1 * loss_db));
        sum_w += power_w.back();
      }
      std::ranges::sort(power_w, std::greater());
      double sinrs = 0.0;
      for (std::size_t c = 0; c < 5; ++c) sinrs += power_w[c] / (sum_w - power_w[c]);
      INFO(model.word << ", height " << height_m << " m");
      CHECK(efficiency[level] == Approx(std::log2(1.0 + sinrs)).epsilon(1e-9));
    }
  }
}
