// The training kernels, written once over a vector type V of 16 floats and compiled once per instruction set. Included
// inside an anonymous namespace after V is defined; no library headers may be included here (see kernels.hpp).
//
// Every sum runs in a fixed order with fused multiply-add, so all instruction sets give the same bits:
// forward over the inputs in ascending order with the bias last, gradients over the samples, deltas over the units of
// the layer above. Units that are zero in the whole batch are left out, and in the gradients most samples whose delta
// is zero: adding a zero changes no sum.

#define ALOFT_UNROLL _Pragma("GCC unroll 64")

constexpr int lanes = batch_lanes;
constexpr unsigned whole_block = (1U << lanes) - 1;

// --- tiles ---------------------------------------------------------------------------------------------------------

/// A size that is known at compile time.
template <int N>
struct Size {};

/// run(Size<size>, first) for a size of at most N.
template <int N, typename Run>
inline void run_tile(int size, int first, const Run& run) {
  if constexpr (N > 1) {
    if (size < N) return run_tile<N - 1>(size, first, run);
  }
  run(Size<N>{}, first);
}

/// Splits 0 .. total - 1 into tiles of at most `most`, as equal as possible: a small tile has too few independent sums
/// to hide their latency. Functions that `run` calls must not be inlined, or they reload their arguments in every loop.
template <int most, typename Run>
inline void in_equal_tiles(int total, const Run& run) {
  int tiles = (total + most - 1) / most;
  for (int first = 0; first < total; --tiles) {
    const int size = (total - first + tiles - 1) / tiles;
    run_tile<most>(size, first, run);
    first += size;
  }
}

// --- output layer -----------------------------------------------------------------------------------------------

/// exp(x) for -87 <= x <= 0, relative error 1e-7: x = n ln 2 + r, Taylor to degree 7 in r.
inline V exp_of(V x) {
  const V magic = V::of(12582912.0F);  // 1.5 * 2^23: adding it rounds to whole numbers
  const V n = sub(fma(x, V::of(1.44269504F), magic), magic);
  V r = fma(n, V::of(-0.693145752F), x);  // ln 2 in two parts
  r = fma(n, V::of(-1.42860677e-6F), r);
  V p = V::of(1.0F / 5040.0F);
  p = fma(p, r, V::of(1.0F / 720.0F));
  p = fma(p, r, V::of(1.0F / 120.0F));
  p = fma(p, r, V::of(1.0F / 24.0F));
  p = fma(p, r, V::of(1.0F / 6.0F));
  p = fma(p, r, V::of(0.5F));
  p = fma(p, r, V::of(1.0F));
  p = fma(p, r, V::of(1.0F));
  return mul(p, power_of_two(n));
}

/// log(1 + e) for 0 <= e <= 1 as 2 atanh(e / (2 + e)).
inline V log1p_of(V e) {
  const V s = div(e, add(e, V::of(2.0F)));
  const V s2 = mul(s, s);
  V p = V::of(1.0F / 15.0F);
  p = fma(p, s2, V::of(1.0F / 13.0F));
  p = fma(p, s2, V::of(1.0F / 11.0F));
  p = fma(p, s2, V::of(1.0F / 9.0F));
  p = fma(p, s2, V::of(1.0F / 7.0F));
  p = fma(p, s2, V::of(0.2F));
  p = fma(p, s2, V::of(1.0F / 3.0F));
  p = fma(p, s2, V::of(1.0F));
  return mul(add(s, s), p);
}

inline void softplus(float* value, float* slope) {
  const V x = V::load(value);
  const V zero = V::of(0.0F);
  const V magnitude = min(max(x, sub(zero, x)), V::of(87.0F));
  const V e = exp_of(sub(zero, magnitude));
  add(max(x, zero), log1p_of(e)).store(value);
  const V sigmoid = div(V::of(1.0F), add(V::of(1.0F), e));  // of |x|
  where_positive(x, sigmoid, mul(e, sigmoid)).store(slope);
}

void output_activation(KernelNetwork& network) {
  const KernelLayer& layer = network.layers[network.layer_count - 1];
  for (int o = 0; o < layer.outputs; ++o) {
    if (layer.activation == Activation::softplus) {
      softplus(network.output + o * lanes, network.slope + o * lanes);
    } else {
      V::of(1.0F).store(network.slope + o * lanes);
    }
  }
}

/// delta = d loss / d sums of the output layer; see ReferenceNetwork::output_delta for the formulas.
void output_delta(KernelNetwork& network, const KernelTraining& training) {
  const int outputs = network.layers[network.layer_count - 1].outputs;
  V sum = V::of(0.0F);
  V labelled = V::of(0.0F);
  for (int o = 0; o < outputs; ++o) {
    const V q = V::load(network.output + o * lanes);
    sum = add(sum, q);
    labelled = fma(q, V::load(network.targets + o * lanes), labelled);
  }
  const V probability = div(labelled, sum);
  const V per_sample = V::of(training.per_sample);
  for (int o = 0; o < outputs; ++o) {
    const V target = V::load(network.targets + o * lanes);
    V d;
    if (training.loss == Loss::mse) {
      const V error = mul(sub(V::load(network.output + o * lanes), target), V::load(network.counted + o * lanes));
      d = mul(error, add(per_sample, per_sample));
    } else {
      d = mul(sub(div(V::of(1.0F), sum), div(target, labelled)), per_sample);
      d = where_between(probability, V::of(1e-7F), V::of(1.0F - 1e-7F), d);
    }
    mul(d, V::load(network.slope + o * lanes)).store(network.delta + o * lanes);
  }
}

// --- forward ----------------------------------------------------------------------------------------------------

/// sums[n] += weight of output n for one input, times the input's row `x`.
template <int N>
inline void add_input(const float* weight, const float* x, V* sums) {
  const V row = V::load(x);
  ALOFT_UNROLL for (int n = 0; n < N; ++n) sums[n] = fma(V::broadcast(weight + n * lanes), row, sums[n]);
}

/// Sums of N outputs from `first` on, for the whole batch.
template <int N>
[[gnu::noinline]] void forward_tile(const KernelLayer& layer, int first, float* to) {
  const float* weights = layer.weights + first * lanes;
  const float* rows = layer.input;
  V sums[N];
  ALOFT_UNROLL for (int n = 0; n < N; ++n) sums[n] = V::of(0.0F);
  for (int block = 0; block < layer.blocks; ++block, weights += layer.block_stride, rows += lanes * lanes) {
    unsigned alive = layer.alive[block];
    if (alive == whole_block) {  // pointers that only move by one are a quarter faster
      const float* x = rows;
      for (const float* w = weights; w != weights + lanes; ++w, x += lanes) add_input<N>(w, x, sums);
    } else {
      for (; alive != 0; alive &= alive - 1) {
        const int i = __builtin_ctz(alive);
        const float* w = weights + i;
        asm("" : "+r"(w));  // a register of its own: indexed addresses double the micro-operations
        add_input<N>(w, rows + i * lanes, sums);
      }
    }
  }
  ALOFT_UNROLL for (int n = 0; n < N; ++n) sums[n].store(to + (first + n) * lanes);
}

void forward_layer(const KernelLayer& layer, float* to) {
  in_equal_tiles<forward_outputs>(layer.outputs, [&]<int N>(Size<N>, int first) { forward_tile<N>(layer, first, to); });
}

/// Applies ReLU to the inputs of `layer` and marks those that are not zero in the whole batch.
void hidden_activation(KernelLayer& layer, Activation activation) {
  if (activation != Activation::relu) return;  // every unit is marked alive at construction
  for (int block = 0; block < layer.blocks; ++block) {
    float* const rows = layer.input + block * lanes * lanes;
    const int units = layer.inputs - block * lanes < lanes ? layer.inputs - block * lanes : lanes;
    unsigned alive = units < lanes ? 1U << units : 0U;  // the constant input
    for (int i = 0; i < units; ++i) {
      const V x = max(V::load(rows + i * lanes), V::of(0.0F));
      x.store(rows + i * lanes);
      alive |= (any_positive(x) ? 1U : 0U) << i;
    }
    layer.alive[block] = alive;
  }
}

void forward(KernelNetwork& network) {
  for (int l = 0; l < network.layer_count; ++l) {
    const bool last = l + 1 == network.layer_count;
    forward_layer(network.layers[l], last ? network.output : network.layers[l + 1].input);
    if (last) {
      output_activation(network);
    } else {
      hidden_activation(network.layers[l + 1], network.layers[l].activation);
    }
  }
}

// --- backward ---------------------------------------------------------------------------------------------------

/// Deltas of B blocks of the layer below. Loads limit this part, so each loaded weight is used for S samples, until all
/// 16 are done. Result: `to` [B blocks][16 samples][16 inputs].
template <int B, int S>
void delta_tile(const KernelLayer& layer, int block, const int* order, int count, const float* delta, float* to) {
  const float* const weights = layer.weights + block * layer.block_stride;
  const long stride = layer.block_stride;
  for (int s = 0; s < lanes; s += S) {
    V sums[B][S];
    ALOFT_UNROLL for (int b = 0; b < B; ++b) {
      ALOFT_UNROLL for (int i = 0; i < S; ++i) sums[b][i] = V::of(0.0F);
    }
    for (int k = 0; k < count; ++k) {
      const float* w = weights + order[k];
      V wb[B];
      ALOFT_UNROLL for (int b = 0; b < B; ++b) wb[b] = V::load(w + b * stride);
      ALOFT_UNROLL for (int i = 0; i < S; ++i) {
        const V d = V::broadcast(delta + k * lanes + s + i);
        ALOFT_UNROLL for (int b = 0; b < B; ++b) sums[b][i] = fma(wb[b], d, sums[b][i]);
      }
    }
    ALOFT_UNROLL for (int b = 0; b < B; ++b) {
      ALOFT_UNROLL for (int i = 0; i < S; ++i) sums[b][i].store(to + (b * lanes + s + i) * lanes);
    }
  }
}

/// Deltas of the layer below for its alive units, in ascending order. `order` and `count`: the outputs of `layer` that
/// have a delta.
void delta_layer(const KernelLayer& layer, Activation below, const int* order, int count, const float* delta,
                 float* to) {
  alignas(64) float by_sample[delta_blocks * lanes * lanes];
  alignas(64) float by_unit[lanes * lanes];
  for (int block = 0; block * lanes < layer.inputs;) {
    const int blocks = block + delta_blocks <= layer.blocks ? delta_blocks : 1;
    if (blocks == delta_blocks) {
      delta_tile<delta_blocks, delta_samples>(layer, block, order, count, delta, by_sample);
    } else {
      delta_tile<1, delta_samples>(layer, block, order, count, delta, by_sample);
    }
    for (int b = 0; b < blocks; ++b, ++block) {
      transpose(by_sample + b * lanes * lanes, lanes, by_unit, lanes);
      const float* const rows = layer.input + block * lanes * lanes;
      for (unsigned alive = layer.alive[block]; alive != 0; alive &= alive - 1) {
        const int i = __builtin_ctz(alive);
        if (block * lanes + i == layer.inputs) break;  // the constant input
        const V d = V::load(by_unit + i * lanes);
        (below == Activation::relu ? where_positive(V::load(rows + i * lanes), d, V::of(0.0F)) : d).store(to);
        to += lanes;
      }
    }
  }
}

// --- weight gradient and Adam -------------------------------------------------------------------------------------

/// The settings of a step. Passed by value, so that the compiler knows that no store changes them.
struct Adam {
  V beta1, beta2, epsilon, step_size;
};

/// 1 / x for normal x > 0, relative error 1e-7. Integer arithmetic on the exponent starts with an error of 12 %; each
/// of two third-order Newton steps cubes it. Adam is limited by the divider, which is left to the square root here; and
/// unlike the hardware's estimates the result is the same on every CPU.
inline V reciprocal(V x) {
  const V one = V::of(1.0F);
  V r = reciprocal_guess(x);
  V e = fnma(x, r, one);
  r = fma(r, fma(e, e, e), r);
  e = fnma(x, r, one);
  return fma(r, fma(e, e, e), r);
}

/// The first half of an Adam step on a block of weights: updates both moments. Returns the root of the second one.
inline V step_moments(float* weights, long moments, V g, Adam adam) {
  float* const first = weights + moments;
  float* const second = first + moments;
  const V m = fma(adam.beta1, V::load(first), g);
  const V v = fma(adam.beta2, V::load(second), mul(g, g));
  m.store(first);
  v.store(second);
  return root(v);
}

/// The second half of an Adam step: updates the weights.
inline void step_weights(float* weights, long moments, V root_of_second, Adam adam) {
  const V r = reciprocal(add(root_of_second, adam.epsilon));
  const V m = V::load(weights + moments);
  fnma(mul(adam.step_size, m), r, V::load(weights)).store(weights);
}

/// Some blocks of a layer's inputs, with all outputs. Passed by value like Adam.
struct GradientTile {
  Adam adam;
  const float* const* inputs;    ///< of each sample
  const float* delta;            ///< [output in the order][16 samples]
  const unsigned char* samples;  ///< same layout, see KernelNetwork
  const int* order;
  float* weights;  ///< of output 0 in the first block
  long block_stride;
  long moments;  ///< from weights to first moments, and on to second ones
};

/// A vector of one output in each of B blocks, and where its weights are.
template <int B>
struct Row {
  V of[B];
  float* weights;
};

/// The gradients of the k-th output in the order, from the first S of its samples. Calls before(s) ahead of the s-th.
template <int B, int S, typename Before>
inline Row<B> gradients_of(const GradientTile& tile, int k, Before before) {
  Row<B> sums;
  sums.weights = tile.weights + tile.order[k];
  const float* const delta = tile.delta + k * lanes;
  const unsigned char* const samples = tile.samples + k * lanes;
  ALOFT_UNROLL for (int b = 0; b < B; ++b) sums.of[b] = V::of(0.0F);
  ALOFT_UNROLL for (int s = 0; s < S; ++s) {
    before(s);
    const V d = V::broadcast(delta + samples[s]);
    const float* const x = tile.inputs[samples[s]];
    ALOFT_UNROLL for (int b = 0; b < B; ++b) sums.of[b] = fma(d, V::load(x + b * lanes), sums.of[b]);
  }
  return sums;
}

/// Two outputs in different stages of their Adam step, interleaved with the gradients of the next output: independent
/// instructions are close together, and square roots run in the divider while the multipliers compute gradients.
template <int B>
struct Pipeline {
  Row<B> gradients;  ///< of the last output
  Row<B> roots;      ///< of the one before, whose moments are done

  void step_weights_of(const GradientTile& tile, int b) const {
    step_weights(roots.weights + b * tile.block_stride, tile.moments, roots.of[b], tile.adam);
  }
  [[nodiscard]] V step_moments_of(const GradientTile& tile, int b) const {
    return step_moments(gradients.weights + b * tile.block_stride, tile.moments, gradients.of[b], tile.adam);
  }
};

/// Treats a group of outputs with at most S samples each. No branch depends on the samples.
template <int B, int S>
Pipeline<B> gradient_group(GradientTile tile, const int* next, const int* end, Pipeline<B> pipeline) {
  for (; next != end; ++next) {
    const Pipeline<B> before = pipeline;
    Row<B> roots;
    roots.weights = before.gradients.weights;
    const auto step = [&](int b) {
      before.step_weights_of(tile, b);
      roots.of[b] = before.step_moments_of(tile, b);
    };
    if constexpr (S == 0) {
      ALOFT_UNROLL for (int b = 0; b < B; ++b) step(b);
    }
    constexpr int parts = S == 0 ? 1 : S;
    pipeline.gradients = gradients_of<B, S>(tile, *next, [&](int s) {
      for (int b = s * B / parts; b < (s + 1) * B / parts; ++b) step(b);
    });
    pipeline.roots = roots;
  }
  return pipeline;
}

/// A layer's outputs, grouped by their number of samples. The last group, with the most samples, is treated first.
struct GradientList {
  const int* members;  ///< of the groups, each with room for all outputs: places in the order
  int outputs;
  int count[gradient_groups];
};

/// The gradients of the `place`-th output to be treated.
template <int B>
Row<B> gradients_in_place(const GradientTile& tile, const GradientList& list, int place) {
  int group = gradient_groups - 1;
  for (; place >= list.count[group]; --group) place -= list.count[group];
  const int k = list.members[group * list.outputs + place];
  Row<B> gradients;
  run_tile<gradient_groups>(group + 1, 0, [&]<int N>(Size<N>, int) {
    gradients = gradients_of<B, (N - 1) * samples_per_group>(tile, k, [](int) {});
  });
  return gradients;
}

/// Treats the groups from G downwards, without the first `done` outputs.
template <int B, int G>
Pipeline<B> gradient_groups_from(const GradientTile& tile, const GradientList& list, int done, Pipeline<B> pipeline) {
  const int skipped = done < list.count[G] ? done : list.count[G];
  const int* const members = list.members + G * list.outputs;
  pipeline = gradient_group<B, G * samples_per_group>(tile, members + skipped, members + list.count[G], pipeline);
  if constexpr (G > 0) pipeline = gradient_groups_from<B, G - 1>(tile, list, done - skipped, pipeline);
  return pipeline;
}

/// Gradients and Adam of B blocks of inputs for all outputs.
template <int B>
[[gnu::noinline]] void gradient_tile(const GradientTile& tile, const GradientList& list) {
  Pipeline<B> pipeline;
  pipeline.gradients = gradients_in_place<B>(tile, list, 0);
  const auto all_moments = [&] {
    ALOFT_UNROLL for (int b = 0; b < B; ++b) pipeline.roots.of[b] = pipeline.step_moments_of(tile, b);
    pipeline.roots.weights = pipeline.gradients.weights;
  };
  const auto all_weights = [&] { ALOFT_UNROLL for (int b = 0; b < B; ++b) pipeline.step_weights_of(tile, b); };
  all_moments();
  if (list.outputs > 1) {
    pipeline.gradients = gradients_in_place<B>(tile, list, 1);
    pipeline = gradient_groups_from<B, gradient_groups - 1>(tile, list, 2, pipeline);
    all_weights();
    all_moments();
  }
  all_weights();
}

void gradient_layer(const KernelNetwork& network, const KernelLayer& layer, const float* delta,
                    const GradientList& list, const Adam& adam) {
  const float* inputs[lanes];
  GradientTile tile;
  tile.adam = adam;
  tile.inputs = inputs;
  tile.delta = delta;
  tile.samples = network.samples;
  tile.order = network.order;
  tile.block_stride = layer.block_stride;
  tile.moments = layer.first_moments - layer.weights;
  in_equal_tiles<gradient_blocks>(layer.blocks, [&]<int B>(Size<B>, int block) {
    for (int s = 0; s < lanes; ++s) inputs[s] = layer.input_by_sample + (s * layer.blocks + block) * lanes;
    tile.weights = layer.weights + block * tile.block_stride;
    gradient_tile<B>(tile, list);
  });
}

/// For each subset of 8 samples: its members, then the other samples, one byte each.
struct SampleOrders {
  unsigned long of_set[256];

  constexpr SampleOrders() : of_set() {
    for (unsigned set = 0; set < 256; ++set) {
      int shift = 0;
      for (unsigned i = 0; i < 16; ++i) {
        if ((set >> i % 8 & 1U) == i / 8) continue;  // members first
        of_set[set] |= static_cast<unsigned long>(i % 8) << shift;
        shift += 8;
      }
    }
  }
};
constexpr SampleOrders sample_orders;

inline void list_samples(unsigned set, unsigned char* to) {
  const unsigned long low = sample_orders.of_set[set & 0xFFU];
  const unsigned long high = sample_orders.of_set[set >> 8] + 0x0808080808080808UL;
  __builtin_memcpy(to, &low, sizeof low);
  __builtin_memcpy(to + 8, &low, sizeof low);  // its other samples end up here
  __builtin_memcpy(to + __builtin_popcount(set & 0xFFU), &high, sizeof high);
}

/// `count`: the first of the outputs in the network's order have a row in `delta`.
GradientList list_gradients(const KernelNetwork& network, int outputs, int count, const float* delta) {
  unsigned char* samples_of = network.samples;
  int* next[gradient_groups];
  for (int group = 0; group < gradient_groups; ++group) next[group] = network.gradient_groups + group * outputs;
  for (int k = 0; k < count; ++k, samples_of += lanes) {
    const unsigned samples = nonzero(V::load(delta + k * lanes));
    list_samples(samples, samples_of);
    *next[(__builtin_popcount(samples) + samples_per_group - 1) / samples_per_group]++ = k;
  }
  for (int k = count; k < outputs; ++k) *next[0]++ = k;
  GradientList list{network.gradient_groups, outputs, {}};
  for (int group = 0; group < gradient_groups; ++group)
    list.count[group] = static_cast<int>(next[group] - list.members) - group * outputs;
  return list;
}

/// The order (offsets of rows) in which a layer's outputs are treated: those with a delta (the alive units of the layer
/// above's input), then the others; returns how many have one. In the output layer all have one.
int order_outputs(const KernelLayer& layer, const KernelLayer* above, int* order) {
  int n = 0;
  int with_delta = 0;
  for (unsigned dead = 0; dead <= whole_block; dead += whole_block) {
    for (int first = 0; first < layer.outputs; first += lanes) {
      const unsigned units = layer.outputs - first < lanes ? (1U << (layer.outputs - first)) - 1 : whole_block;
      const unsigned alive = above == nullptr ? whole_block : above->alive[first / lanes];
      for (unsigned chosen = (alive ^ dead) & units; chosen != 0; chosen &= chosen - 1)
        order[n++] = (first + __builtin_ctz(chosen)) * lanes;
    }
    if (dead == 0) with_delta = n;
  }
  return with_delta;
}

void backward(KernelNetwork& network, const Adam& adam) {
  float* delta = network.delta;
  float* below = network.delta_below;
  for (int l = network.layer_count - 1; l >= 0; --l) {
    const KernelLayer& layer = network.layers[l];
    const bool last = l + 1 == network.layer_count;
    const int count = order_outputs(layer, last ? nullptr : network.layers + l + 1, network.order);
    if (l > 0) {
      delta_layer(layer, network.layers[l - 1].activation, network.order, count, delta, below);
      for (int i = 0; i < layer.blocks; ++i)
        transpose(layer.input + i * lanes * lanes, lanes, layer.input_by_sample + i * lanes, layer.blocks * lanes);
    }
    gradient_layer(network, layer, delta, list_gradients(network, layer.outputs, count, delta), adam);
    float* const swap = delta;
    delta = below;
    below = swap;
  }
}

void train(KernelNetwork& network, const KernelTraining& training) {
  for (int epoch = 0; epoch < training.epochs; ++epoch) {
    forward(network);
    output_delta(network, training);
    backward(network, {V::of(training.beta1), V::of(training.beta2), V::of(training.epsilon),
                       V::of(training.step_sizes[epoch])});
  }
}

#undef ALOFT_UNROLL
