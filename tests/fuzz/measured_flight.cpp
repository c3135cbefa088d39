// CSV files of measured flights.
#include "common/world/measured_flight.hpp"

#include "tests/fuzz/target.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace aloft;
  fuzz::accepted([&] {
    const world::MeasuredFlight flight = world::parse_measured_flight(fuzz::text(data, size), "input");
    const std::size_t cells = std::size_t{flight.steps} * flight.heights;
    fuzz::require(cells > 0 && flight.throughput_kbps.size() == cells && flight.sinr_db.size() == cells &&
                      (flight.serving_cell.empty() || flight.serving_cell.size() == cells),
                  "a column is not steps times heights long");
  });
  return 0;
}
