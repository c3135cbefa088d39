#pragma once

#include <algorithm>
#include <cstddef>
#include <string_view>

#include "common/learn/network.hpp"

namespace aloft::learn {

/// Random samples for tests: inputs in (-1, 1), targets in (0, 3) for one counted output each.
inline Minibatch random_minibatch(const NetworkShape& shape, std::size_t size, Loss loss, std::string_view name) {
  RandomStream random(7, 0, name);
  Minibatch batch{size, std::vector<float>(size * shape.inputs()), std::vector<float>(size * shape.outputs(), 0.0F),
                  std::vector<float>(size * shape.outputs(), 0.0F)};
  for (float& x : batch.inputs) x = static_cast<float>(random.uniform(-1.0, 1.0));
  for (std::size_t s = 0; s < size; ++s) {
    const std::size_t at = s * shape.outputs() + random.uniform_index(static_cast<std::uint32_t>(shape.outputs()));
    batch.targets[at] = loss == Loss::mse ? static_cast<float>(random.uniform(0.0, 3.0)) : 1.0F;
    batch.counted[at] = 1.0F;
  }
  return batch;
}

}  // namespace aloft::learn
