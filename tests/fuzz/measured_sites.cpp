// CSV files of base stations beside measured flights.
#include "common/world/measured_sites.hpp"

#include <array>
#include <cmath>

#include "tests/fuzz/target.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace aloft;
  constexpr std::array<world::GeoPosition, 2> route{{{53.34, -6.24}, {53.35, -6.23}}};
  fuzz::accepted([&] {
    const world::MeasuredSites known = world::parse_measured_sites(fuzz::text(data, size), "input", route);
    fuzz::require(!known.sites.empty() && known.route.size() == route.size(), "no base stations, or no route");
    for (const world::Site& site : known.sites)
      fuzz::require(std::hypot(site.position.x_m, site.position.y_m) <= 1.001 * world::measured_map_radius_m &&
                        std::fabs(site.azimuth_deg) <= 180.0,
                    "a base station is out of range");
  });
  return 0;
}
