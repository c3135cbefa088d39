#pragma once

// The boundary between the network classes and the kernels. The kernels' translation units are compiled for one
// instruction set each, so this header must stay free of library headers: of an inline function that several units
// have, the linker could keep the copy that this CPU cannot run.

namespace aloft::learn {

/// Samples of a batch, and floats of a block: one AVX-512 register or two AVX2 registers.
inline constexpr int batch_lanes = 16;

enum class Activation : int { linear, relu, softplus };

enum class Loss : int {
  mse,            ///< mean over the batch of the counted outputs' squared errors
  cross_entropy,  ///< Keras: outputs normalised to sum 1, one-hot targets, clipped to [1e-7, 1 - 1e-7]
};

/// Outputs are grouped by how many samples have a delta: none, 1 to 4, .. 13 to 16. Each group has code of its own;
/// more groups would exceed the CPU's cache of decoded instructions.
inline constexpr int samples_per_group = 4;
inline constexpr int gradient_groups = batch_lanes / samples_per_group + 1;

/// One dense layer. All arrays are aligned to 64 bytes. The bias is the weight of one more input that is always 1.
struct KernelLayer {
  int inputs;
  int outputs;
  int blocks;  ///< of 16 inputs, the constant one included
  Activation activation;
  long block_stride;       ///< floats from one block to the next: 16 for each output, and padding
  float* weights;          ///< [block][output][16 inputs]; zero beyond the bias
  float* first_moments;    ///< same layout, scaled (see AdamSettings); in the same allocation, after the weights
  float* second_moments;   ///< same layout, scaled; at the same distance after the first moments
  float* input;            ///< [16 * blocks][16 samples]: inputs, a row of ones, zeros
  float* input_by_sample;  ///< [16 samples][16 * blocks]
  unsigned* alive;         ///< [block]: bit i for input i of the block, unless it is zero in the whole batch
};

struct KernelNetwork {
  int layer_count;
  KernelLayer* layers;
  float* output;           ///< [output][16 samples]
  float* slope;            ///< of the output activation, same layout
  float* targets;          ///< same layout
  float* counted;          ///< same layout
  float* delta;            ///< d loss / d sums of a layer: [unit in the layer's order][16 samples]
  float* delta_below;      ///< of the layer below
  int* order;              ///< 16 times the numbers of a layer's outputs: those with a delta first
  unsigned char* samples;  ///< [output in the order][16]: samples whose delta is not zero, ascending, then the others
  int* gradient_groups;    ///< [group of outputs with similarly many samples][output]: places in the order
};

struct KernelTraining {
  Loss loss;
  float per_sample;  ///< 1 / samples
  int epochs;
  const float* step_sizes;  ///< [epoch], see AdamSettings
  float beta1;
  float beta2;
  float epsilon;  ///< scaled
};

/// The functions that are compiled for each instruction set.
struct Kernels {
  /// From layers[0].input and its alive bits to output. Rows of later layers' inputs and their alive bits are filled.
  void (*forward)(KernelNetwork& network);
  /// Epochs of forward, backward and Adam on the batch in layers[0].input and input_by_sample. `output` is left as it
  /// was before the last update.
  void (*train)(KernelNetwork& network, const KernelTraining& training);
};

const Kernels& avx2_kernels();
const Kernels& avx512_kernels();

}  // namespace aloft::learn
