#include "common/agents/pretrained_model.hpp"

#include <fmt/format.h>
#include <idl/model.pb.h>

#include <algorithm>
#include <cmath>

#include "common/agents/pretrained_state.hpp"
#include "common/base/digest.hpp"
#include "common/base/error.hpp"

namespace aloft::agents {
namespace {

constexpr std::uint32_t format_version = 1;

[[noreturn]] void refuse(std::string_view where, std::string_view reason) {
  throw InputError(
      "{}: not a usable model: {}; train one with 'aloft train pretrained', or leave the agent's parameter "
      "'model' empty for the built-in one",
      where, reason);
}

void add(proto::Model& model, std::string_view quality, const PretrainedModel::Network& network) {
  proto::ModelNetwork& to = *model.add_networks();
  to.set_quality(std::string(quality));
  to.set_hidden_width(static_cast<std::uint32_t>(network.hidden_width));
  to.mutable_weights()->Add(network.weights.begin(), network.weights.end());
}

PretrainedModel::Network take(const proto::Model& model, std::string_view quality, std::string_view where) {
  for (const proto::ModelNetwork& network : model.networks()) {
    if (network.quality() != quality) continue;
    const std::size_t width = network.hidden_width();
    if (width < 1 || width > learn::max_layer_width)
      refuse(where, fmt::format("its hidden layers have {} units, allowed are 1 to {}", width, learn::max_layer_width));
    const std::size_t needed = pretrained_shape(width).parameters();
    if (static_cast<std::size_t>(network.weights_size()) != needed)
      refuse(where, fmt::format("its network for {} has {} weights where {} are needed", quality,
                                network.weights_size(), needed));
    if (!std::ranges::all_of(network.weights(), [](float w) { return std::isfinite(w); }))
      refuse(where, "a weight is not a finite number");
    return {width, {network.weights().begin(), network.weights().end()}};
  }
  refuse(where, fmt::format("it has no network for {}", quality));
}

}  // namespace

learn::NetworkShape pretrained_shape(std::size_t hidden_width) {
  using learn::Activation;
  return {{{PretrainedState::inputs, hidden_width, Activation::relu},
           {hidden_width, hidden_width, Activation::relu},
           {hidden_width, 3, Activation::linear}}};
}

std::size_t preferred_action(std::span<const float, 3> values) noexcept {
  std::size_t best = 1;
  if (values[0] > values[best]) best = 0;
  if (values[2] > values[best]) best = 2;
  return best;
}

std::string PretrainedModel::to_bytes() const {
  proto::Model model;
  model.set_state_layout_version(PretrainedState::layout_version);
  model.set_training_config(training_config);
  add(model, "spectral_efficiency", spectral_efficiency);
  add(model, "throughput", throughput);
  proto::SealedModel sealed;
  sealed.set_format_version(format_version);
  sealed.set_model(model.SerializeAsString());
  sealed.set_sha256(sha256_hex(sealed.model()));
  return sealed.SerializeAsString();
}

PretrainedModel parse_pretrained_model(std::string_view bytes, std::string_view where) {
  proto::SealedModel sealed;
  if (!sealed.ParseFromArray(bytes.data(), static_cast<int>(bytes.size())))
    refuse(where, fmt::format("its {} bytes are truncated or not a model file", bytes.size()));
  if (sealed.format_version() > format_version)
    refuse(where, fmt::format("it has the newer format {}, this program reads up to {}", sealed.format_version(),
                              format_version));
  if (sealed.format_version() == 0 || sealed.sha256().empty() ||
      !sealed.GetReflection()->GetUnknownFields(sealed).empty())
    refuse(where, "it is truncated or not a model file");
  if (sha256_hex(sealed.model()) != sealed.sha256())
    refuse(where, "its checksum does not match: the content was altered");
  proto::Model model;
  if (!model.ParseFromString(sealed.model())) refuse(where, "its content is not a model");
  if (model.state_layout_version() != PretrainedState::layout_version)
    refuse(where, fmt::format("it was trained for state layout {}, this program has layout {}",
                              model.state_layout_version(), PretrainedState::layout_version));
  return {take(model, "spectral_efficiency", where), take(model, "throughput", where), model.training_config()};
}

}  // namespace aloft::agents
