// NPZ files of radio maps; bytes that are no ZIP archive are an array of such a file, the powers.
#include "tools/importer/radio_map.hpp"

#include "common/world/measured_flight.hpp"
#include "tests/fuzz/target.hpp"
#include "tools/importer/test_npz.hpp"

namespace {

/// The small map of the tests with these powers.
std::string with_powers(std::string_view npy) {
  auto members = aloft::importer::test::small_map();
  members.front().second = npy;
  return aloft::importer::test::npz(members);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace aloft;
  const std::string input(fuzz::text(data, size));
  fuzz::accepted([&] {
    const importer::RadioMap map(importer::NpzFile(input.starts_with("PK") ? input : with_powers(input), "input"),
                                 -150.0);
    (void)importer::sites_csv(map, {}, "input");
    importer::MapOptions options;
    options.route = {{map.x_m().front(), map.y_m().front()}, {map.x_m().back(), map.y_m().back()}};
    options.heights = {map.z_m().front(), map.z_m()[1], map.z_m()[1] - map.z_m()[0]};
    (void)world::parse_measured_flight(importer::to_csv(importer::map_world(map, options, "input")), "the world");
  });
  return 0;
}
