#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "common/agents/observation.hpp"
#include "common/learn/shape.hpp"

namespace aloft::agents {

/// PretrainedState::inputs - hidden - hidden (ReLU) - 3 (linear: down, hold, up).
[[nodiscard]] learn::NetworkShape pretrained_shape(std::size_t hidden_width);

/// The action of the largest value: 0 down, 1 hold, 2 up. On ties hold, then down.
[[nodiscard]] std::size_t preferred_action(std::span<const float, 3> values) noexcept;

/// The content of a model file (idl/model.proto).
struct PretrainedModel {
  struct Network {
    std::size_t hidden_width = 0;
    std::vector<float> weights;  ///< layout of learn::NetworkState
  };
  Network spectral_efficiency;
  Network throughput;
  std::string training_config;  ///< canonical JSON

  [[nodiscard]] const Network& network(QosKind kind) const noexcept {
    return kind == QosKind::throughput ? throughput : spectral_efficiency;
  }
  /// The file's bytes: equal models give equal bytes.
  [[nodiscard]] std::string to_bytes() const;
};

/// `where` names the file in messages. Throws InputError with the reason if the file is truncated, altered, of a newer
/// format or for another state layout, or if networks are missing or of a wrong size.
[[nodiscard]] PretrainedModel parse_pretrained_model(std::string_view bytes, std::string_view where);

}  // namespace aloft::agents
