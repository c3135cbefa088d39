#pragma once

#include <cstddef>
#include <span>

namespace aloft::importer {

/// The radio of a file that holds levels instead of throughputs.
struct RadioOptions {
  double bandwidth_mhz = 10.0;
  double noise_figure_db = 9.0;
  double spectral_efficiency_max = 7.4063;  ///< bit/s/Hz: 256-QAM (TS 38.214, Table 5.1.3.1-2); 0: none
  double serving_load = 1.0;                ///< for RSRQ: share of the serving cell's resource elements in use
};

/// SINRs above this are cut off: what modems report.
inline constexpr double sinr_max_db = 30.0;

/// bandwidth min(log2(1 + SINR), spectral_efficiency_max), kbit/s.
[[nodiscard]] double throughput_kbps(double sinr_db, const RadioOptions& radio);

/// SINR of reference symbols from RSRQ = RSRP N / RSSI, where the RSSI of a resource block is that of twelve
/// subcarriers, of which the serving cell uses the share `load` (TS 36.214, 5.1.3):
/// SINR = 1 / (1 / (12 RSRQ) - load), at most sinr_max_db.
[[nodiscard]] double sinr_from_rsrq_db(double rsrq_db, double load);

/// Thermal noise, -174 dBm/Hz, in this bandwidth, plus the noise figure.
[[nodiscard]] double noise_dbm(double bandwidth_hz, double noise_figure_db);

/// A serving cell and its SINR.
struct Serving {
  std::size_t cell = 0;
  double sinr_db = 0.0;
};

/// The strongest of these powers over noise and the sum of the others; the first of equal ones. At least one power.
[[nodiscard]] Serving strongest(std::span<const double> power_dbm, double noise_dbm);

}  // namespace aloft::importer
