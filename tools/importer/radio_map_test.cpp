#include "tools/importer/radio_map.hpp"

#include <catch2/catch.hpp>
#include <limits>

#include "common/base/error.hpp"
#include "common/world/measured_flight.hpp"
#include "common/world/measured_sites.hpp"
#include "tools/importer/test_npz.hpp"

using namespace aloft;
using namespace aloft::importer;
using namespace aloft::importer::test;
using Catch::Contains;

namespace {

using Members = std::vector<std::pair<std::string, std::string>>;

RadioMap map_of(const Members& members, std::optional<double> floor_dbm = {}) {
  return {NpzFile(npz(members), "map.npz"), floor_dbm};
}

/// The small map with one member replaced or added.
Members with(const std::string& name, const std::string& content) {
  Members members = small_map();
  std::erase_if(members, [&](const auto& member) { return member.first == name; });
  members.emplace_back(name, content);
  return members;
}

Members with_axis(const std::string& name, const std::vector<double>& values) {
  return with(name, npy("<f8", "(" + std::to_string(values.size()) + ",)", bytes_of(values)));
}

Members with_power(std::size_t index, double value) {
  std::vector<double> power(24, -70.0);
  power[index] = value;
  return with("power_dbm.npy", npy("<f8", "(2, 2, 2, 3)", bytes_of(power)));
}

std::string error_of(const Members& members) {
  try {
    static_cast<void>(map_of(members));
  } catch (const InputError& error) {
    return error.what();
  }
  return "accepted";
}

const std::vector<world::Position> east{{0, 5}, {20, 5}};

}  // namespace

TEST_CASE("between its points a radio map is linear along each axis, in dB") {
  const RadioMap map = map_of(small_map());
  // -60 + 12.5 - 2.5 and -80 + 24: the small map is linear in x, y and z
  const std::vector<double> inside = map.power_dbm({12.5, 2.5}, 24.0);
  CHECK(inside[0] == Approx(-50.0).margin(1e-9));
  CHECK(inside[1] == Approx(-56.0).margin(1e-9));
  CHECK(map.power_dbm({20, 10}, 30)[0] == -50.0);  // its last corner
  CHECK(map.power_dbm({0, 0}, 20)[1] == -60.0);    // and its first
  // One point of eight at -170 instead of -70 dBm takes an eighth of the middle: -70 - 100 / 8
  CHECK(map_of(with_power(0, -170.0)).power_dbm({5, 5}, 25)[0] == Approx(-82.5).margin(1e-9));
}

TEST_CASE("a route through a radio map: the strongest cell serves, over noise and the sum of the others") {
  MapOptions options;
  options.route = east;
  options.heights.step_m = 5.0;
  options.radio = {.bandwidth_mhz = 20.0, .noise_figure_db = 7.0, .spectral_efficiency_max = 0.0};
  const ImportedWorld world = map_world(map_of(small_map()), options, "map.npz");
  REQUIRE(world.height_m == std::vector<double>{20, 25, 30});
  REQUIRE(world.route.size() == 3);  // x = 0, 10, 20
  // x = 0, 20 m: -65 dBm of cell 0 and -60 dBm of cell 1, noise -174 + 73.0103 + 7 = -93.9897 dBm:
  // 10^-6 / (10^-6.5 + 10^-9.39897) = 3.158300: 4.9945 dB, and 20 MHz x log2(4.158300) = 41120.2 kbit/s
  CHECK(world.values[0].serving_cell == 1);
  CHECK(world.values[0].sinr_db == Approx(4.9945).margin(1e-4));
  CHECK(world.values[0].throughput_kbps == Approx(41120.2).epsilon(1e-5));
  // x = 20, 20 m: -45 dBm over -60 dBm
  CHECK(world.values[6].serving_cell == 0);
  CHECK(world.values[6].sinr_db == Approx(14.9983).margin(1e-4));
  options.radio.spectral_efficiency_max = 2.0;
  CHECK(map_world(map_of(small_map()), options, "map.npz").values[6].throughput_kbps == 40'000.0);

  const auto located = world::parse_located_flight(to_csv(world), "out.csv");
  CHECK(located.flight.steps == 3);
  CHECK(located.flight.serving_cell[6] == 0);
  CHECK_FALSE(located.flight.sinr_derived);
  CHECK(located.route[2].longitude_deg == Approx(20.0 / 111319.49).margin(5.1e-8));  // at the equator
}

TEST_CASE("cells have numbers and sites if the file gives them") {
  Members members = with("cell.npy", npy("<i4", "(2,)", bytes_of(std::vector<std::int32_t>{310, 77})));
  members.emplace_back("site.npy", npy("<f8", "(2, 3)", bytes_of(std::vector<double>{0, 0, 25, 100, 50, 30.5})));
  const RadioMap map = map_of(members);
  CHECK(map.cells() == std::vector<std::int32_t>{310, 77});
  MapOptions options;
  options.route = east;
  CHECK(map_world(map, options, "x").values[0].serving_cell == 77);
  CHECK(sites_csv(map, {53.34, -6.24}, "x")
            .starts_with("cell,latitude,longitude,antenna_height_m\n310,53.3400000,-6.2400000,25\n77,53.340449"));
  const std::vector<world::GeoPosition> route{{53.34, -6.24}};
  const auto known = world::parse_measured_sites(sites_csv(map, route[0], "x"), "sites.csv", route);
  CHECK(known.sites[0].position.x_m == Approx(100.0).margin(0.01));  // by cell: 77, 310
  CHECK(known.sites[0].position.y_m == Approx(50.0).margin(0.01));
  CHECK(sites_csv(map_of(small_map()), {}, "x").empty());
}

TEST_CASE("no power at all counts as the floor, if there is one") {
  const Members members = with_power(0, -std::numeric_limits<double>::infinity());
  CHECK(map_of(members, -150.0).power_dbm({0, 0}, 20)[0] == -150.0);
  CHECK_THAT(error_of(members),
             Contains("power_dbm[0, 0, 0, 0] is -inf: a hole at z = 20, y = 0, x = 0 m") && Contains("--floor"));
}

TEST_CASE("maps that cannot be used are refused with what, where and the range") {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  CHECK(error_of(small_map()) == "accepted");
  CHECK_THAT(error_of(with_power(23, nan)), Contains("power_dbm[1, 1, 1, 2] is nan") &&
                                                Contains("z = 30, y = 10, x = 20 m") && Contains("-200 to 200 dBm"));
  CHECK_THAT(error_of(with_power(8, 300)), Contains("power_dbm[0, 1, 0, 2] is 300"));
  CHECK_THAT(error_of(with_axis("x.npy", {0, 20, 10})), Contains("x[2] is 10, not above 20") && Contains("increase"));
  CHECK_THAT(error_of(with_axis("x.npy", {0, 10, 10})), Contains("x[2] is 10, not above 10"));
  CHECK_THAT(error_of(with_axis("z.npy", {20, nan})), Contains("z[1] is nan") && Contains("-100000 to 100000"));
  CHECK_THAT(error_of(with_axis("y.npy", {0})), Contains("at least two coordinates"));
  CHECK_THAT(error_of(with_axis("y.npy", {0, 5, 10})),
             Contains("power_dbm: has the shape (2, 2, 2, 3); it must be [cell, z, y, x], which is (2, 2, 3, 3) here"));
  CHECK_THAT(error_of(with("power_dbm.npy", npy("<f8", "()", bytes_of(std::vector<double>{1})))), Contains("shape ()"));
  CHECK_THAT(error_of(with("cell.npy", npy("<f8", "(2,)", bytes_of(std::vector<double>{1, 1})))), Contains("twice"));
  CHECK_THAT(error_of(with("cell.npy", npy("<f8", "(2,)", bytes_of(std::vector<double>{1, 1.5})))),
             Contains("cell[1] is 1.5") && Contains("0 to 2147483647"));
  CHECK_THAT(error_of(with("cell.npy", npy("<f8", "(1,)", bytes_of(std::vector<double>{1})))), Contains("[cell]"));
  CHECK_THAT(error_of(with("site.npy", npy("<f8", "(2,)", bytes_of(std::vector<double>{1, 1})))),
             Contains("[cell, 3]"));
  Members without = small_map();
  without.pop_back();
  CHECK_THAT(error_of(without), Contains("has no array 'z'"));
}

TEST_CASE("routes and heights that leave the map, and masts that no file can have, are refused") {
  const RadioMap map = map_of(small_map());
  const auto error = [&](const std::vector<world::Position>& route, const HeightOptions& heights) {
    MapOptions options;
    options.route = route;
    options.heights = heights;
    try {
      static_cast<void>(map_world(map, options, "map.npz"));
    } catch (const InputError& refusal) {
      return std::string(refusal.what());
    }
    return std::string("accepted");
  };
  CHECK(error(east, {}) == "accepted");
  CHECK_THAT(error({}, {}), Contains("--route"));
  CHECK_THAT(error({{0, 5}, {21, 5}}, {}),
             Contains("map.npz: --route at x = 21 m leaves the map, which has x from 0 to 20 m"));
  CHECK_THAT(error({{0, -1}}, {}), Contains("y = -1 m"));
  CHECK_THAT(error(east, {.min_m = 10.0}), Contains("a height at z = 10 m leaves the map") && Contains("20 to 30 m"));
  CHECK_THAT(error(east, {.max_m = 40.0}), Contains("z = 40 m"));
  CHECK_THAT(error(east, {.step_m = 50.0}), Contains("0 heights") && Contains("--height-step"));
  const Members high = with("site.npy", npy("<f8", "(2, 3)", bytes_of(std::vector<double>{0, 0, 25, 1, 5, 300})));
  CHECK_THROWS_WITH(sites_csv(map_of(high), {}, "x"), Contains("site[1, 2] is 300") && Contains("1 to 200 m"));
}
