#include "common/radio/expected_field.hpp"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <nlohmann/json.hpp>
#include <numeric>
#include <optional>

#include "common/radio/generated_world.hpp"
#include "common/radio/testing/plain_radio.hpp"
#include "common/world/city.hpp"

using namespace aloft;
using aloft::radio::PlainRadio;
using nlohmann::json;

namespace {

std::vector<world::Site> sites_of(const world::City& city) {
  std::vector<world::Site> sites;
  for (const world::Position& position : city.base_stations)
    sites.push_back({static_cast<std::int32_t>(sites.size()), position, 37.0 * static_cast<double>(sites.size() % 10)});
  return sites;
}

/// The field by its definition, one place at a time, in the preset `published` with changes of these keys only. Without
/// buildings, or among those of a city.
class PlainField {
 public:
  PlainField(const Parameters& world, const std::vector<world::Site>& sites, std::optional<world::City> city = {})
      : world_(world), sites_(sites), radio_(world, sites, std::move(city)) {}

  [[nodiscard]] double at(world::Position uav, double h) const {
    std::vector<std::size_t> order(sites_.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::stable_sort(order.begin(), order.end(),
                     [&](auto a, auto b) { return power_w(uav, a, h) > power_w(uav, b, h); });
    if (world_.text("serving_selection") != "best-of-all")
      order.resize(std::min(order.size(), static_cast<std::size_t>(world_.integer("candidates"))));
    const double noise_w = std::pow(10.0, (-174 + 10 * std::log10(20e6) + 10) / 10) / 1000;
    double sum = 0.0;
    for (const std::size_t c : order) {
      double interference_w = 0.0;
      for (std::size_t k = 0; k < sites_.size(); ++k)
        if (k != c && radio_.interferes(uav, c, k, h)) interference_w += power_w(uav, k, h);
      const double alone = interference_w == 0.0 && world_.text("fading") != "none" ? 0.5614594835668851 : 1.0;
      sum += alone * power_w(uav, c, h) / (noise_w + interference_w);
    }
    return std::log2(1.0 + sum);
  }

  [[nodiscard]] bool blocked(world::Position uav, std::size_t k, double h) const { return radio_.blocked(uav, k, h); }

 private:
  [[nodiscard]] double power_w(world::Position uav, std::size_t k, double h) const { return radio_.power_w(uav, k, h); }

  Parameters world_;
  std::vector<world::Site> sites_;
  PlainRadio radio_;
};

}  // namespace

TEST_CASE("the expected field is what its definition says, over small and large cities") {
  for (const json& given :
       {json::object(), json{{"bs_density_per_km2", 1}},
        json{{"bs_density_per_km2", 25}, {"candidates", 2}, {"neighbours", 0}},
        json{{"fading", "none"}, {"height_step_m", 5}}, json{{"fading", "correlated"}, {"path_exponent_los", 3}},
        json{{"uav_antenna", "omnidirectional"}, {"serving_selection", "best-of-all"}}}) {
    INFO(given.dump());
    const Parameters world = radio::resolve_generated_world(given, "world");
    for (std::uint32_t trial = 0; trial < 3; ++trial) {
      const world::City city = world::generate_city(world, 7, trial);
      radio::ExpectedField field(world, sites_of(city));
      const PlainField plain(world, sites_of(city));
      std::vector<double> column(field.levels());
      REQUIRE(column.size() == static_cast<std::size_t>(200 / world.number("height_step_m")) + 1);
      for (double x_m = -500; x_m <= 500; x_m += 125) {
        const world::Position uav{x_m, x_m / 100};
        field.column(uav, column.data());
        for (std::size_t level = 0; level < column.size(); ++level) {
          const double height_m = 40 + world.number("height_step_m") * static_cast<double>(level);
          INFO("trial " << trial << ", x " << x_m << " m, height " << height_m << " m");
          CHECK(column[level] == Approx(plain.at(uav, height_m)).epsilon(1e-9));
        }
      }
    }
  }
}

TEST_CASE("the expected field among buildings is what its definition says, and so is the share of blocked links") {
  for (const json& given : {json{{"building_height_mean_m", 40}}, json{{"preset", "geometric"}}}) {
    INFO(given.dump());
    const Parameters world = radio::resolve_generated_world(given, "world");
    const auto sites = sites_of(world::generate_city(world, 7, 0));
    world::City other = world::generate_city(world, 7, 0);
    const world::City drawn = world::generate_city(world, 99, 3);
    world::draw_buildings(world, 99, 3, other);
    CHECK(other.building_height_m == drawn.building_height_m);
    radio::ExpectedField field(world, sites, 99, 3);
    const PlainField plain(world, sites, other);
    std::vector<world::Position> places;
    std::size_t blocked = 0;
    std::vector<double> column(field.levels());
    for (double x_m = -500; x_m <= 500; x_m += 125) {
      places.push_back({x_m, x_m / 100});
      field.column(places.back(), column.data());
      for (std::size_t level = 0; level < column.size(); ++level) {
        INFO("x " << x_m << " m, level " << level);
        CHECK(column[level] == Approx(plain.at(places.back(), 40 + 10 * static_cast<double>(level))).epsilon(1e-9));
      }
      for (std::size_t k = 0; k < sites.size(); ++k) blocked += plain.blocked(places.back(), k, 40) ? 1 : 0;
    }
    CHECK(blocked > 0);
    CHECK(field.blocked_share(places) ==
          Approx(static_cast<double>(blocked) / static_cast<double>(places.size() * sites.size())));
    CHECK(radio::ExpectedField(world, {}, 99, 3).blocked_share(places) == 0.0);
  }
}

TEST_CASE("buildings do not enter the expected field") {
  const json few{{"building_density_per_km2", 1}};
  const json many{{"building_density_per_km2", 900}, {"building_height_mean_m", 200}};
  std::vector<std::vector<double>> columns;
  for (const json& given : {few, many}) {
    const Parameters world = radio::resolve_generated_world(given, "world");
    radio::ExpectedField field(world, sites_of(world::generate_city(world, 7, 0)));
    columns.emplace_back(field.levels());
    field.column({}, columns.back().data());
  }
  CHECK(columns[0] == columns[1]);
}

TEST_CASE("without sites nothing is expected") {
  radio::ExpectedField field(radio::resolve_generated_world(json::object(), "world"), {});
  std::vector<double> column(field.levels(), 1.0);
  field.column({}, column.data());
  CHECK(column == std::vector<double>(field.levels(), 0.0));
}
