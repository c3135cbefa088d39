#pragma once

#include <cstdint>
#include <vector>

#include "common/base/parameters.hpp"
#include "common/world/world.hpp"

namespace aloft::world {

/// The parameters of a city: densities, heights, and the window that base stations and buildings fill.
[[nodiscard]] const std::vector<ParameterSpec>& city_parameters();

/// The city of one trial.
///
/// Base stations: Poisson(density * window^2) many, redrawn until there are min_base_stations, at uniform positions; or
/// on a hexagonal grid of this density, whose shift is uniform, and redrawn likewise.
/// Buildings: on a grid of floor(sqrt(n)) x ceil(sqrt(n)) cell centres, n = density * window^2, with independent
/// heights. Streams: "base station count", "base station positions", "hexagonal grid", "building heights", so
/// conditions that differ in one density share everything else. `world` holds at least the keys of city_parameters().
/// Throws InputError if there are more base stations than limits::base_stations, or if almost no draw has enough of
/// them.
[[nodiscard]] City generate_city(const Parameters& world, std::uint64_t seed, std::uint32_t trial);

/// Draws the buildings of a trial anew: the grid and the heights of generate_city() with this seed and trial. Of the
/// city, only its window and its buildings are touched.
void draw_buildings(const Parameters& world, std::uint64_t seed, std::uint32_t trial, City& city);

/// Cells that share a site, and so their links' line of sight and shadowing: base stations n k to n k + n - 1 of a city
/// with n.
[[nodiscard]] std::uint32_t cells_per_site(const Parameters& world);

/// The distance of neighbouring base stations on a hexagonal grid.
[[nodiscard]] double hexagonal_distance_m(double density_per_km2);

/// The probability that a Poisson draw of the number of base stations is at least min_base_stations. Of a hexagonal
/// grid: 1 if its mean number is, so that some shifts have as many, else 0.
[[nodiscard]] double probability_of_enough_stations(const Parameters& world);

}  // namespace aloft::world
