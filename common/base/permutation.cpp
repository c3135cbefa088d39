#include "common/base/permutation.hpp"

#include <numeric>
#include <utility>

namespace aloft {

std::vector<std::uint32_t> permutation(std::uint32_t n, RandomStream& random) {
  std::vector<std::uint32_t> order(n);
  std::iota(order.begin(), order.end(), 0U);
  for (std::uint32_t i = n; i > 1; --i) std::swap(order[i - 1], order[random.uniform_index(i)]);
  return order;
}

}  // namespace aloft
