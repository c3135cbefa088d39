// R workspaces: gzip files as they are, and the content of such files.
#include "tools/importer/r_workspace.hpp"

#include "common/world/measured_flight.hpp"
#include "tests/fuzz/target.hpp"
#include "tools/importer/measurement_grid.hpp"
#include "tools/importer/test_workspace.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace aloft;
  const std::string input(fuzz::text(data, size));
  fuzz::accepted([&] {
    const importer::NumericVectors vectors =
        importer::parse_r_workspace(input.starts_with("\x1f\x8b") ? input : importer::test::gzip(input), "input");
    const importer::MeasurementGrid grid = importer::rebuild_grid(vectors, {}, "input");
    (void)world::parse_measured_flight(importer::to_csv(grid), "the grid");
  });
  return 0;
}
