#include "tools/importer/link_quality.hpp"

#include <algorithm>
#include <cmath>

namespace aloft::importer {
namespace {

double ratio_of(double db) {
  return std::pow(10.0, 0.1 * db);
}

}  // namespace

double throughput_kbps(double sinr_db, const RadioOptions& radio) {
  const double efficiency = std::log2(1.0 + ratio_of(sinr_db));
  const double most = radio.spectral_efficiency_max > 0.0 ? radio.spectral_efficiency_max : efficiency;
  return 1e3 * radio.bandwidth_mhz * std::min(efficiency, most);
}

double sinr_from_rsrq_db(double rsrq_db, double load) {
  const double interference = 1.0 / (12.0 * ratio_of(rsrq_db)) - load;  // and noise, over the serving cell's power
  return interference <= 0.0 ? sinr_max_db : std::min(-10.0 * std::log10(interference), sinr_max_db);
}

double noise_dbm(double bandwidth_hz, double noise_figure_db) {
  constexpr double thermal_dbm_per_hz = -174.0;
  return thermal_dbm_per_hz + 10.0 * std::log10(bandwidth_hz) + noise_figure_db;
}

Serving strongest(std::span<const double> power_dbm, double noise_dbm) {
  const auto serving = std::ranges::max_element(power_dbm);
  double others = ratio_of(noise_dbm);  // mW
  for (auto power = power_dbm.begin(); power != power_dbm.end(); ++power)
    if (power != serving) others += ratio_of(*power);
  return {static_cast<std::size_t>(serving - power_dbm.begin()), *serving - 10.0 * std::log10(others)};
}

}  // namespace aloft::importer
