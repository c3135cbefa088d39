#include "bench/step_traffic.hpp"

#include <algorithm>

#include "bench/cache_model.hpp"

namespace bench {
namespace {

using namespace aloft;

constexpr std::size_t line_bytes = 64;

/// The sizes of the tiles in which the kernels of a path go through a layer (kernels_avx2.cpp, kernels_avx512.cpp).
struct Tiles {
  std::size_t forward_outputs;
  std::size_t delta_blocks;
  std::size_t delta_samples;
  std::size_t gradient_blocks;
};

/// A line holds the weights of 16 inputs to one output. Padding is never touched, so it does not count.
struct Layer {
  std::size_t blocks;
  std::size_t outputs;
  std::size_t first_line;

  [[nodiscard]] std::size_t lines() const { return blocks * outputs; }
  [[nodiscard]] std::size_t line(std::size_t block, std::size_t output) const {
    return first_line + block * outputs + output;
  }
};

template <typename Run>
void in_equal_tiles(std::size_t total, std::size_t most, const Run& run) {
  std::size_t tiles = (total + most - 1) / most;
  for (std::size_t first = 0; first < total; --tiles) {
    const std::size_t size = (total - first + tiles - 1) / tiles;
    run(first, first + size);
    first += size;
  }
}

/// Calls use(line) for all lines that a gradient step touches.
template <typename Use>
void go_through_step(const std::vector<Layer>& layers, const Tiles& tiles, const Use& use) {
  for (const Layer& layer : layers)
    in_equal_tiles(layer.outputs, tiles.forward_outputs, [&](std::size_t first, std::size_t end) {
      for (std::size_t block = 0; block < layer.blocks; ++block)
        for (std::size_t output = first; output < end; ++output) use(layer.line(block, output));
    });
  for (std::size_t l = layers.size(); l-- > 0;) {
    const Layer& layer = layers[l];
    for (std::size_t block = 0; l > 0 && block < layer.blocks; block += tiles.delta_blocks)
      for (std::size_t sample = 0; sample < 16; sample += tiles.delta_samples)
        for (std::size_t output = 0; output < layer.outputs; ++output)
          for (std::size_t b = block; b < std::min(block + tiles.delta_blocks, layer.blocks); ++b)
            use(layer.line(b, output));
    in_equal_tiles(layer.blocks, tiles.gradient_blocks, [&](std::size_t first, std::size_t end) {
      for (std::size_t output = 0; output < layer.outputs; ++output)
        for (std::size_t block = first; block < end; ++block)
          for (std::size_t array = 0; array < 3; ++array) use(layer.line(block, output) + array * layer.lines());
    });
  }
}

}  // namespace

StepTraffic step_traffic(const learn::NetworkShape& shape, learn::Path path, const std::vector<CacheLevel>& levels) {
  const Tiles tiles = path == learn::Path::avx512 ? Tiles{25, 3, 8, 7} : Tiles{5, 1, 4, 5};
  std::vector<Layer> layers;
  std::size_t lines = 0;
  for (const learn::LayerShape& layer : shape.layers) {
    layers.push_back({(layer.inputs + 1 + 15) / 16, layer.outputs, lines});
    lines += 3 * layers.back().lines();
  }
  std::vector<CacheModel> caches;
  for (const CacheLevel& level : levels)
    if (level.bytes > 0) caches.emplace_back(level.bytes / line_bytes, lines);
  StepTraffic traffic{lines * line_bytes, std::vector<std::size_t>(levels.size())};
  for (const bool count : {false, true}) {  // the first step fills the caches
    go_through_step(layers, tiles, [&](std::size_t line) {
      std::size_t from = 0;
      while (from < caches.size() && !caches[from].use(line)) ++from;
      if (count) traffic.bytes_from[from] += line_bytes;
    });
  }
  return traffic;
}

}  // namespace bench
