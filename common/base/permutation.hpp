#pragma once

#include <cstdint>
#include <vector>

#include "common/base/random.hpp"

namespace aloft {

/// 0, ..., n - 1 in random order, all orders equally likely (Fisher-Yates).
[[nodiscard]] std::vector<std::uint32_t> permutation(std::uint32_t n, RandomStream& random);

}  // namespace aloft
