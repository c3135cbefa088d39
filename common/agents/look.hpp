#pragma once

#include <string>
#include <vector>

namespace aloft::agents {

/// The rank of agents that have none of their own.
inline constexpr int default_rank = 90;

/// How tables and charts show an agent. Colours follow Okabe-Ito and Tol and differ in lightness, too.
struct Look {
  std::string agent;        ///< its name in the experiment
  int rank = default_rank;  ///< the lowest comes first
  std::string light{};      ///< colour on a light background: "#2a9fd0"
  std::string dark{};       ///< colour on a dark background
  std::vector<int> dash{};  ///< lengths of the strokes and gaps of its lines; {1, 0}: solid
};

}  // namespace aloft::agents
