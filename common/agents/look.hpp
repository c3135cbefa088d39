#pragma once

#include <string>
#include <vector>

namespace aloft::agents {

/// The rank of agents whose type sets none.
inline constexpr int default_rank = 90;

/// How tables and charts show an agent. Colours follow the palettes of Okabe and Ito, and of Tol; they
/// also differ in lightness.
struct Look {
  std::string agent;        ///< its name in the experiment
  int rank = default_rank;  ///< the lowest comes first
  std::string light{};      ///< colour on a light background: "#2a9fd0"
  std::string dark{};       ///< colour on a dark background
  std::vector<int> dash{};  ///< lengths of the strokes and gaps of its lines; {1, 0}: solid
};

}  // namespace aloft::agents
