#pragma once

// The boundary between the network classes and the kernels. The kernels' translation units are compiled for one
// instruction set each, so this header must stay free of library headers: the linker could otherwise pick code of
// theirs for a CPU that cannot run it.

namespace aloft::learn {

/// Samples of a batch, and floats of a block: one AVX-512 register or two AVX2 registers.
inline constexpr int batch_lanes = 16;

enum class Activation : int { linear, relu, softplus };

enum class Loss : int {
  mse,            ///< mean over the batch of the counted outputs' squared errors
  cross_entropy,  ///< Keras: outputs normalised to sum 1, one-hot targets, clipped to [1e-7, 1 - 1e-7]
};

}  // namespace aloft::learn
