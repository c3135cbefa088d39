#pragma once

#include <string>
#include <vector>

namespace aloft::agents {

/// The rank of agents whose type sets none.
inline constexpr int default_rank = 90;

/// How tables and charts show an agent. No two colours of the palette (tools/report/agent_list.hpp) are alike, and
/// those that are near each other, or are for red-green-blind eyes, have different dashes.
struct Look {
  std::string agent;        ///< its name in the experiment
  int rank = default_rank;  ///< the lowest comes first
  std::string light{};      ///< colour on a light background: "#139fce"
  std::string dark{};       ///< colour on a dark background
  std::vector<int> dash{};  ///< lengths of the strokes and gaps of its lines; {1, 0}: solid
};

}  // namespace aloft::agents
