// Payloads from the wire: the first byte chooses the topic, by its row in topics.def.
#include <spdlog/spdlog.h>

#include "tests/fuzz/receive.hpp"
#include "tests/fuzz/target.hpp"

namespace {
const bool quiet = (spdlog::set_level(spdlog::level::off), true);
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using aloft::fuzz::receivers;
  if (size > 0) receivers[data[0] % std::size(receivers)]({data + 1, size - 1});
  return 0;
}
