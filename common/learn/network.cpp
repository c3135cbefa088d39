#include "common/learn/network.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "common/learn/blocked_network.hpp"
#include "common/learn/reference.hpp"

namespace aloft::learn {

NetworkState initial_state(const NetworkShape& shape, RandomStream& random) {
  NetworkState state;
  state.weights.reserve(shape.parameters());
  for (const LayerShape& layer : shape.layers) {
    const double limit = std::sqrt(6.0 / static_cast<double>(layer.inputs + layer.outputs));
    for (std::size_t o = 0; o < layer.outputs; ++o) {
      for (std::size_t i = 0; i < layer.inputs; ++i)
        state.weights.push_back(static_cast<float>(random.uniform(-limit, limit)));
      state.weights.push_back(0.0F);
    }
  }
  state.first_moments.assign(state.weights.size(), 0.0F);
  state.second_moments = state.first_moments;
  return state;
}

void check_minibatch(const NetworkShape& shape, const Minibatch& minibatch) {
  const std::size_t n = minibatch.size;
  if (n == 0 || n > static_cast<std::size_t>(batch_lanes) || minibatch.inputs.size() != n * shape.inputs() ||
      minibatch.targets.size() != n * shape.outputs() || minibatch.counted.size() != n * shape.outputs())
    throw std::logic_error(fmt::format("a minibatch of {} samples does not fit the network", n));
}

std::string_view path_name(Path path) noexcept {
  switch (path) {
    case Path::portable:
      return "portable";
    case Path::avx2:
      return "avx2";
    case Path::avx512:
      return "avx512";
  }
  return "";
}

std::vector<Path> available_paths() {
  std::vector<Path> paths{Path::portable};
#if defined(ALOFT_X86_KERNELS)
  if (__builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma")) paths.push_back(Path::avx2);
  if (__builtin_cpu_supports("avx512f") && paths.back() == Path::avx2) paths.push_back(Path::avx512);
#endif
  return paths;
}

std::unique_ptr<Network> make_network(const NetworkShape& shape, const AdamSettings& adam) {
  return make_network(shape, adam, available_paths().back());
}

std::unique_ptr<Network> make_network(const NetworkShape& shape, const AdamSettings& adam, Path path) {
  const std::vector<Path> paths = available_paths();
  if (std::find(paths.begin(), paths.end(), path) == paths.end())
    throw std::logic_error(fmt::format("this CPU has no path '{}'", path_name(path)));
#if defined(ALOFT_X86_KERNELS)
  if (path == Path::avx512) return std::make_unique<BlockedNetwork>(shape, adam, avx512_kernels());
  if (path == Path::avx2) return std::make_unique<BlockedNetwork>(shape, adam, avx2_kernels());
#endif
  return std::make_unique<PortableNetwork>(shape, adam);
}

}  // namespace aloft::learn
