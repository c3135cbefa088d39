#include "common/radio/generated_world.hpp"

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>
#include <vector>

#include "common/base/error.hpp"
#include "common/radio/serving_rule.hpp"

using namespace aloft;
using nlohmann::json;

namespace {

std::string error_of(const json& given) {
  try {
    static_cast<void>(radio::resolve_generated_world(given, "world"));
  } catch (const InputError& error) {
    return error.what();
  }
  return "accepted";
}

}  // namespace

TEST_CASE("the default world is the published one") {
  const Parameters world = radio::resolve_generated_world(json::object(), "world");
  CHECK(world.text("preset") == "published");
  CHECK(world.text("los_ray") == "published");
  CHECK(world.text("bs_antenna") == "array");
  CHECK(world.text("fading") == "independent");
  CHECK(world.number("height_min_m") == 40.0);
  CHECK(world.integer("steps") == 100);
  CHECK(world.number("tx_power_w") == 40.0);
}

TEST_CASE("a preset changes the defaults, and given keys override it") {
  Parameters world = radio::resolve_generated_world({{"preset", "paper-text"}}, "world");
  CHECK(world.text("uav_antenna") == "omnidirectional");
  CHECK(world.text("bs_antenna") == "sector");
  CHECK(world.text("path_distance") == "horizontal");
  CHECK(world.text("fading") == "none");
  CHECK(world.text("serving_selection") == "best-of-all");
  world = radio::resolve_generated_world({{"preset", "geometric"}, {"fading_correlation", 0.5}}, "world");
  CHECK(world.text("los_ray") == "geometric");
  CHECK(world.text("building_height_distribution") == "rayleigh");
  CHECK(world.number("building_height_mean_m") == Approx(20.0 * 1.2533141).epsilon(1e-5));  // 20 sqrt(pi/2)
  CHECK(world.text("fading") == "correlated");
  CHECK(world.number("fading_correlation") == 0.5);
  CHECK(world.text("uav_antenna") == "directional");
}

TEST_CASE("resolving a resolved world gives the same world") {
  for (const char* preset : {"published", "paper-text", "geometric", "3gpp-uma", "3gpp-umi", "3gpp-rma",
                             "3gpp-uma-poisson", "3gpp-umi-poisson", "3gpp-rma-poisson"})
    for (const json& given :
         {json{{"height_step_m", 20}, {"candidates", 6}, {"height_max_m", 240}}, json{{"propagation", "power-law"}},
          json{{"spectral_efficiency_max", 0}}, json{{"deployment", "poisson"}}, json{{"serving", "a3"}}}) {
      json all = given;
      all["preset"] = preset;
      const Parameters world = radio::resolve_generated_world(all, "world");
      const Parameters again = radio::resolve_generated_world(world.to_json(), "world");
      CHECK(again.to_json() == world.to_json());
      CHECK(again.text("propagation") == world.text("propagation"));
      CHECK(again.text("deployment") == world.text("deployment"));
      CHECK(again.number("spectral_efficiency_max") == world.number("spectral_efficiency_max"));
    }
}

TEST_CASE("the presets of 3GPP have its channel models, and its hexagonal grids of sites") {
  const auto resolved = [](const char* preset) {
    return radio::resolve_generated_world({{"preset", preset}}, "world");
  };
  const Parameters urban = resolved("3gpp-uma");
  CHECK(urban.text("propagation") == "uma-av");
  CHECK(urban.text("deployment") == "hexagonal");
  CHECK(urban.text("cells_per_site") == "three");
  CHECK(urban.text("bs_antenna") == "3gpp");
  CHECK(urban.number("bs_downtilt_deg") == 10.0);
  CHECK(urban.number("base_station_height_m") == 25.0);
  CHECK(urban.number("bs_density_per_km2") == Approx(4.6188).margin(1e-4));  // 1 / (500 m x 433.0 m)
  CHECK(urban.number("tx_power_w") == Approx(39.81).margin(1e-2));           // 46 dBm
  CHECK(urban.number("carrier_ghz") == 2.0);
  CHECK(urban.number("spectral_efficiency_max") == Approx(8.0 * 948 / 1024).margin(1e-4));
  const Parameters micro = resolved("3gpp-umi");
  CHECK(micro.text("propagation") == "umi-av");
  CHECK(micro.number("bs_density_per_km2") == Approx(28.8675).margin(1e-4));
  CHECK(micro.number("tx_power_w") == Approx(12.589).margin(1e-3));  // 41 dBm
  const Parameters rural = resolved("3gpp-rma");
  CHECK(rural.text("propagation") == "rma-av");
  CHECK(rural.number("bs_density_per_km2") == Approx(0.38493).margin(1e-4));
  CHECK(rural.number("carrier_ghz") == 0.7);
}

TEST_CASE("worlds have the parameters of handover only if networks hand the UAV over") {
  const Parameters strongest = radio::resolve_generated_world({{"preset", "3gpp-uma"}}, "world");
  CHECK_FALSE(radio::a3_rules(strongest));
  for (const char* key : {"serving", "a3_offset_db", "t310_s"}) CHECK_FALSE(strongest.to_json().contains(key));
  CHECK(radio::resolve_generated_world({{"serving", "strongest"}}, "world").to_json() ==
        radio::resolve_generated_world(json::object(), "world").to_json());

  // Table A.2.1-1 of TR 36.777; Qout, Qin and T310 of TR 36.839.
  const auto rules = radio::a3_rules(radio::resolve_generated_world({{"serving", "a3"}}, "world"));
  REQUIRE(rules);
  CHECK(rules->offset_db == 2.0);
  CHECK(rules->time_to_trigger_s == 0.16);
  CHECK(rules->l3_filter_k == 1);
  CHECK(rules->l1_window_s == 0.2);
  CHECK(rules->measurement_error_db == 1.22);
  CHECK(rules->preparation_s == 0.05);
  CHECK(rules->execution_s == 0.04);
  CHECK(rules->minimum_stay_s == 1.0);
  CHECK(rules->qout_db == -8.0);
  CHECK(rules->qin_db == -6.0);
  CHECK(rules->t310_s == 1.0);
  // Every parameter reaches its rule.
  const auto other = radio::a3_rules(radio::resolve_generated_world({{"serving", "a3"},
                                                                     {"a3_offset_db", 3},
                                                                     {"time_to_trigger_s", 0.01},
                                                                     {"l3_filter_k", 4},
                                                                     {"l1_window_s", 0.5},
                                                                     {"measurement_error_db", 0.02},
                                                                     {"handover_preparation_s", 0.03},
                                                                     {"handover_execution_s", 0.06},
                                                                     {"minimum_stay_s", 0.07},
                                                                     {"qout_db", -9},
                                                                     {"qin_db", -5},
                                                                     {"t310_s", 0.08},
                                                                     {"reestablishment_s", 0.09}},
                                                                    "world"));
  REQUIRE(other);
  CHECK(std::vector{other->offset_db, other->time_to_trigger_s, 1.0 * other->l3_filter_k, other->l1_window_s,
                    other->measurement_error_db, other->preparation_s, other->execution_s, other->minimum_stay_s,
                    other->qout_db, other->qin_db, other->t310_s, other->reestablishment_s} ==
        std::vector{3.0, 0.01, 4.0, 0.5, 0.02, 0.03, 0.06, 0.07, -9.0, -5.0, 0.08, 0.09});
}

TEST_CASE("the Poisson presets of 3GPP are the hexagonal ones with sites at random places") {
  for (const std::string preset : {"3gpp-uma", "3gpp-umi", "3gpp-rma"}) {
    json hexagonal = radio::resolve_generated_world({{"preset", preset}}, "world").to_json();
    json random = radio::resolve_generated_world({{"preset", preset + "-poisson"}}, "world").to_json();
    CHECK(hexagonal["deployment"] == "hexagonal");
    CHECK(random.value("deployment", "poisson") == "poisson");
    for (json* world : {&hexagonal, &random}) {
      world->erase("deployment");
      world->erase("preset");
    }
    CHECK(random == hexagonal);
  }
}

TEST_CASE("the route's largest offset follows the height step unless it is given") {
  CHECK(radio::resolve_generated_world({{"height_step_m", 20}}, "world").number("route_offset_max_m") == 20.0);
  CHECK(radio::resolve_generated_world({{"height_step_m", 20}, {"route_offset_max_m", 7}}, "world")
            .number("route_offset_max_m") == 7.0);
}

TEST_CASE("wrong worlds are refused with path, value and what is allowed") {
  using Catch::Contains;
  CHECK_THAT(error_of({{"bs_densty_per_km2", 5}}), Contains("world.bs_densty_per_km2") && Contains("unknown key") &&
                                                       Contains("Did you mean 'bs_density_per_km2'"));
  CHECK_THAT(error_of({{"bs_density_per_km2", -1}}),
             Contains("world.bs_density_per_km2") && Contains("from 0.1 to 500"));
  CHECK_THAT(error_of({{"preset", "text"}}), Contains("world.preset") && Contains("paper-text"));
  CHECK_THAT(error_of({{"height_max_m", 235}}), Contains("world.height_step_m") && Contains("no multiple"));
  CHECK_THAT(error_of({{"height_max_m", 30}}), Contains("world.height_max_m") && Contains("below height_min_m 40"));
  CHECK_THAT(error_of({{"height_resolution_m", 3}}), Contains("world.height_resolution_m") && Contains("divide"));
  CHECK_THAT(error_of({{"height_resolution_m", 0.1}, {"height_max_m", 2040}}),
             Contains("world.height_resolution_m") && Contains("more than 4096 heights"));
  CHECK(error_of({{"height_resolution_m", 0.1}, {"height_step_m", 0.1}, {"height_max_m", 40 + 409.5}}) == "accepted");
  CHECK_THAT(error_of({{"height_resolution_m", 0.1}, {"height_step_m", 0.1}, {"height_max_m", 40 + 409.6}}),
             Contains("world.height_resolution_m") && Contains("more than 4096 heights"));
  CHECK_THAT(error_of({{"bs_density_per_km2", 0.1}, {"window_m", 2000}}),
             Contains("world.min_base_stations: only one in") && Contains("cities has 6 or more base stations"));
  CHECK(error_of({{"bs_density_per_km2", 0.1}}) == "accepted");
  CHECK_THAT(error_of({{"bs_density_per_km2", 0.6}, {"deployment", "hexagonal"}}),
             Contains("world.min_base_stations: 6 is more than a hexagonal grid"));
  CHECK(error_of({{"bs_density_per_km2", 0.7}, {"deployment", "hexagonal"}}) == "accepted");
  CHECK_THAT(error_of({{"height_min_m", 20}}), Contains("world.height_min_m") && Contains("base_station_height_m 30"));
  CHECK_THAT(error_of({{"steps", 300}}), Contains("world.route_start_x_m") && Contains("leaves the city"));
  CHECK_THAT(error_of({{"candidates", 10}}), Contains("world.min_base_stations") && Contains("at least 10"));
  CHECK_THAT(error_of({{"neighbours", 5}, {"min_base_stations", 5}}), Contains("at least 6"));
  CHECK_THAT(error_of({{"route_offset_max_m", 800}, {"window_m", 1100}}), Contains("world.route_offset_max_m"));
  CHECK(error_of({{"neighbours", 5}}) == "accepted");
  CHECK_THAT(error_of({{"cells_per_site", "three"}}), Contains("world.cells_per_site") && Contains("\"3gpp\""));
  CHECK(error_of({{"cells_per_site", "three"}, {"bs_antenna", "3gpp"}}) == "accepted");
  CHECK_THAT(
      error_of({{"cells_per_site", "three"}, {"bs_antenna", "3gpp"}, {"bs_density_per_km2", 500}, {"window_m", 8000}}),
      Contains("world.cells_per_site: three at each of 32000 sites") && Contains("65536"));
  CHECK(error_of({{"bs_density_per_km2", 500}, {"window_m", 10'000}}) == "accepted");
}
