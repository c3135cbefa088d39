#include "common/radio/station_rows.hpp"

#include <cmath>
#include <cstddef>

#include "common/base/widest_vectors.hpp"

namespace aloft::radio {
namespace {

[[gnu::always_inline]] inline void look_loop(world::Position uav, const double* x_m, const double* y_m,
                                             std::size_t size, double* dx_m, double* dy_m, double* distance_m) {
  for (std::size_t k = 0; k < size; ++k) {
    dx_m[k] = x_m[k] - uav.x_m;
    dy_m[k] = y_m[k] - uav.y_m;
    distance_m[k] = std::sqrt(dx_m[k] * dx_m[k] + dy_m[k] * dy_m[k]);
  }
}

[[gnu::always_inline]] inline void sector_loop(const RadioModel* model, const world::Position* boresight,
                                               const double* dx_m, const double* dy_m, const double* distance_m,
                                               std::size_t size, double* covers) {
  for (std::size_t k = 0; k < size; ++k)
    covers[k] = sector_covers(*model, {dx_m[k], dy_m[k], distance_m[k]}, boresight[k]) ? 1.0 : 0.0;
}

template <BsAntenna antenna>
[[gnu::always_inline]] inline void station_power_loop(const RadioModel* model, const double* distance_m,
                                                      const double* horizontal_loss_db, double rise_m, std::size_t size,
                                                      double* gain_to_power_w) {
  for (std::size_t k = 0; k < size; ++k)
    gain_to_power_w[k] =
        received_power_w<antenna>(*model, distance_m[k], rise_m, horizontal_loss_db[k], gain_to_power_w[k]);
}

[[gnu::always_inline]] inline void azimuth_loss_loop(const world::Position* boresight, const double* dx_m,
                                                     const double* dy_m, const double* distance_m, std::size_t size,
                                                     double* loss_db) {
  for (std::size_t k = 0; k < size; ++k) loss_db[k] = azimuth_loss_db({dx_m[k], dy_m[k], distance_m[k]}, boresight[k]);
}

[[gnu::always_inline]] inline void beam_loop(const RadioModel* model, Link towards, BeamLimits limits,
                                             const double* dx_m, const double* dy_m, const double* distance_m,
                                             std::size_t size, double* disturbs) {
  for (std::size_t k = 0; k < size; ++k) {
    const bool inside = same_azimuth(*model, towards, {dx_m[k], dy_m[k], distance_m[k]}) &
                        (distance_m[k] >= limits.nearest_m) & (distance_m[k] <= limits.farthest_m);
    disturbs[k] = inside ? 1.0 : 0.0;
  }
}

}  // namespace

StationRows::StationRows(const std::vector<world::Position>& stations)
    : dx_m(stations.size()), dy_m(stations.size()), distance_m(stations.size()), horizontal_loss_db(stations.size()) {
  for (const world::Position& station : stations) {
    x_m.push_back(station.x_m);
    y_m.push_back(station.y_m);
  }
}

void look_from(world::Position uav, StationRows& rows) {
  run_vectorised<look_loop>(uav, rows.x_m.data(), rows.y_m.data(), rows.x_m.size(), rows.dx_m.data(), rows.dy_m.data(),
                            rows.distance_m.data());
}

void sector_row(const RadioModel& model, const std::vector<world::Position>& boresights, const StationRows& rows,
                double* covers) {
  run_vectorised<sector_loop>(&model, boresights.data(), rows.dx_m.data(), rows.dy_m.data(), rows.distance_m.data(),
                              rows.x_m.size(), covers);
}

void azimuth_loss_row(const std::vector<world::Position>& boresights, StationRows& rows) {
  run_vectorised<azimuth_loss_loop>(boresights.data(), rows.dx_m.data(), rows.dy_m.data(), rows.distance_m.data(),
                                    rows.x_m.size(), rows.horizontal_loss_db.data());
}

void received_powers(const RadioModel& model, const StationRows& rows, double rise_m, double* gain_to_power_w) {
  const auto run = [&]<BsAntenna antenna>() {
    run_vectorised<station_power_loop<antenna>>(&model, rows.distance_m.data(), rows.horizontal_loss_db.data(), rise_m,
                                                rows.distance_m.size(), gain_to_power_w);
  };
  switch (model.bs_antenna) {
    case BsAntenna::array:
      return run.template operator()<BsAntenna::array>();
    case BsAntenna::sector:
      return run.template operator()<BsAntenna::sector>();
    case BsAntenna::tr_38_901:
      return run.template operator()<BsAntenna::tr_38_901>();
  }
}

void beam_row(const RadioModel& model, const StationRows& rows, std::uint32_t c, const BeamLimits& limits,
              double* disturbs) {
  run_vectorised<beam_loop>(&model, Link{rows.dx_m[c], rows.dy_m[c], rows.distance_m[c]}, limits, rows.dx_m.data(),
                            rows.dy_m.data(), rows.distance_m.data(), rows.x_m.size(), disturbs);
}

}  // namespace aloft::radio
