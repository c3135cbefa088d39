#include "common/radio/signal_map.hpp"

namespace aloft::radio {

void SignalMap::prepare() {
  if (!fixed_route()) return;
  static_cast<void>(column(0, start()));
  for (std::uint32_t step = 1; step <= steps(); ++step)
    static_cast<void>(column(result_point(step), advance(result_point(step), start(), -1)));
}

}  // namespace aloft::radio
