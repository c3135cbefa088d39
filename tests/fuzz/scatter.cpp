// CSV files of measurements that lie anywhere, with the columns of the sample.
#include "common/world/measured_flight.hpp"
#include "tests/fuzz/target.hpp"
#include "tools/importer/scatter_world.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace aloft;
  importer::ScatterColumns columns;
  columns.altitude = "altitude_m";
  columns.value = "sinr_db";
  columns.cell = "cell";
  columns.time = "time";
  importer::ScatterOptions options;
  options.reach = {100.0, 20.0};
  fuzz::accepted([&] {
    const importer::Scatter scatter = importer::parse_scatter(fuzz::text(data, size), "input", columns);
    const importer::HeldOut held_out = importer::held_out_error(scatter, options);
    fuzz::require(held_out.all.samples == scatter.samples.size() && held_out.all.predicted <= held_out.all.samples,
                  "held-out samples are lost");
    importer::ImportedWorld world;
    try {
      world = importer::scatter_world(scatter, options, "input");
    } catch (const InputError&) {
      return;  // a hole, or too few heights
    }
    (void)world::parse_measured_flight(importer::to_csv(world), "the world");
  });
  return 0;
}
