#pragma once

#include <cstddef>
#include <memory>
#include <vector>

#include "common/learn/kernels.hpp"
#include "common/learn/network.hpp"

namespace aloft::learn {

/// Zero-initialised floats on a 64-byte boundary.
class AlignedFloats {
 public:
  explicit AlignedFloats(std::size_t count);
  [[nodiscard]] float* data() noexcept { return data_.get(); }
  [[nodiscard]] const float* data() const noexcept { return data_.get(); }

 private:
  struct Free {
    void operator()(float* p) const noexcept;
  };
  std::unique_ptr<float[], Free> data_;  // NOLINT(modernize-avoid-c-arrays): owns aligned memory
};

/// A network whose arithmetic is done by kernels of one instruction set, in their block layout.
class BlockedNetwork final : public Network {
 public:
  BlockedNetwork(NetworkShape shape, const AdamSettings& adam, const Kernels& kernels);

  [[nodiscard]] const NetworkShape& shape() const noexcept override { return shape_; }
  [[nodiscard]] NetworkState state() const override;
  void load(const NetworkState& state) override;
  void predict(std::span<const float> inputs, std::span<float> outputs) override;
  double train(const Minibatch& minibatch, Loss loss, std::size_t epochs) override;

 private:
  using Array = float* KernelLayer::*;

  void build_layers();
  float* allocate(std::size_t count);
  [[nodiscard]] std::vector<float> flat(Array member) const;
  void fill(Array member, std::span<const float> values);
  void load_inputs(std::span<const float> inputs, std::size_t samples);
  void load_targets(const Minibatch& minibatch);
  [[nodiscard]] double loss_of(const Minibatch& minibatch, Loss loss) const;

  NetworkShape shape_;
  AdamSettings adam_;
  const Kernels& kernels_;
  std::uint64_t steps_ = 0;
  std::vector<AlignedFloats> memory_;
  std::vector<std::vector<unsigned>> alive_;
  std::vector<int> order_;
  std::vector<unsigned char> samples_;
  std::vector<int> gradient_groups_;
  std::vector<KernelLayer> layers_;
  KernelNetwork network_{};
};

}  // namespace aloft::learn
