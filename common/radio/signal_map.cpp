#include "common/radio/signal_map.hpp"

#include <stdexcept>

namespace aloft::radio {

void SignalMap::prepare() {
  if (!fixed_route()) return;
  static_cast<void>(column(0, start()));
  for (std::uint32_t step = 1; step <= steps(); ++step)
    static_cast<void>(column(result_point(step), advance(result_point(step), start(), -1)));
}

void SignalMap::scan(std::uint32_t, world::Position, std::uint32_t, std::span<const std::int32_t>, CellScan&) {
  throw std::logic_error("this map knows the serving cell alone, so that no other one can be handed over to");
}

}  // namespace aloft::radio
