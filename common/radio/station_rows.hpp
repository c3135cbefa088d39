#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "common/radio/link_budget.hpp"
#include "common/world/world.hpp"

/// The formulas of link_budget.hpp over the base stations of a city at one height, in a file of their own with the
/// compiler options of vectorised loops. Each element has the same bits as the formula for that base station.
namespace aloft::radio {

/// Values per base station.
struct StationRows {
  explicit StationRows(const std::vector<world::Position>& stations);

  std::vector<double> x_m;
  std::vector<double> y_m;
  // Their links, seen from the UAV.
  std::vector<double> dx_m;
  std::vector<double> dy_m;
  std::vector<double> distance_m;
  std::vector<double> horizontal_loss_db;  ///< of the antenna of TR 38.901; else 0
};

/// Fills the links of a UAV above `uav`.
void look_from(world::Position uav, StationRows& rows);

/// covers[k] = 1 if the sector antenna of base station k covers the UAV, else 0.
void sector_row(const RadioModel& model, const std::vector<world::Position>& boresights, const StationRows& rows,
                double* covers);

/// Fills horizontal_loss_db for antennas with these boresights.
void azimuth_loss_row(const std::vector<world::Position>& boresights, StationRows& rows);

/// received_power_w() of every base station: `gain_to_power_w` holds the channel model's gains before and powers after.
void received_powers(const RadioModel& model, const StationRows& rows, double rise_m, double* gain_to_power_w);

/// disturbs[k] = 1 if base station k is within the UAV's beam towards base station c, with the azimuth and these limits
/// of distance, else 0.
void beam_row(const RadioModel& model, const StationRows& rows, std::uint32_t c, const BeamLimits& limits,
              double* disturbs);

}  // namespace aloft::radio
