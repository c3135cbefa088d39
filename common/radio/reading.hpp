#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "common/base/limits.hpp"

namespace aloft::radio {

inline constexpr std::size_t max_neighbours = limits::neighbours;

/// The quantity that measures quality of service, and its unit.
enum class QosKind : std::uint8_t {
  spectral_efficiency,  ///< bit/s/Hz
  throughput,           ///< kbit/s
};

/// The UAV modem's measurements at one place.
struct Reading {
  double qos = 0.0;  ///< bit/s/Hz or kbit/s: SignalMap::qos_kind
  double serving_sinr_db = 0.0;
  std::int32_t serving_cell = -1;
  std::uint32_t neighbour_count = 0;
  std::array<double, max_neighbours> neighbour_sinr_db{};  ///< descending
};

/// One cell at one place.
struct CellReading {
  std::int32_t cell = -1;
  double power_dbm = 0.0;  ///< received, before fast fading: what a measurement averages
  double sinr_db = 0.0;    ///< were it to serve
  double qos = 0.0;        ///< likewise
};

}  // namespace aloft::radio
