// Traces of flights. One that is accepted can be measured and is the same after it was written again.
#include "common/flight/metrics.hpp"
#include "common/store/result_store.hpp"
#include "tests/fuzz/target.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace aloft;
  fuzz::accepted([&] {
    const flight::FlightRecord record = store::decode_trace(fuzz::text(data, size));
    const std::string written = store::encode_trace(record);
    fuzz::require(store::encode_trace(store::decode_trace(written)) == written, "a trace changes when written again");
    (void)flight::measure(record, {});
  });
  return 0;
}
