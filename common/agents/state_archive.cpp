#include "common/agents/state_archive.hpp"

#include <fmt/format.h>
#include <idl/agent_state.pb.h>

#include <algorithm>
#include <bit>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "common/base/digest.hpp"
#include "common/base/error.hpp"

namespace aloft::agents {
namespace {

constexpr std::uint32_t format_version = 1;

std::string parameters_hash(const Parameters& parameters) {
  return sha256_hex(parameters.to_json().dump());
}

[[noreturn]] void refuse_state(std::string_view agent_type, std::string_view reason) {
  throw IntegrityError(
      "agent state refused: {} (expected a state of agent '{}'); start it afresh or from another checkpoint", reason,
      agent_type);
}

template <typename T>
std::span<const T> as_span(const google::protobuf::RepeatedField<T>& field) {
  return {field.data(), static_cast<std::size_t>(field.size())};
}

}  // namespace

struct StateWriter::Impl {
  proto::AgentState state;

  proto::NamedArray& add(std::string_view name) {
    for (const proto::NamedArray& array : state.arrays())
      if (array.name() == name) throw std::logic_error(fmt::format("state field '{}' is written twice", name));
    proto::NamedArray& array = *state.add_arrays();
    array.set_name(std::string(name));
    return array;
  }
};

StateWriter::StateWriter(std::string_view agent_type, const Parameters& parameters) : impl_(std::make_unique<Impl>()) {
  impl_->state.set_version(format_version);
  impl_->state.set_agent_type(std::string(agent_type));
  impl_->state.set_parameters_sha256(parameters_hash(parameters));
}

StateWriter::~StateWriter() = default;

void StateWriter::put(std::string_view name, std::span<const double> values) {
  impl_->add(name).mutable_doubles()->Add(values.begin(), values.end());
}

void StateWriter::put(std::string_view name, std::span<const float> values) {
  impl_->add(name).mutable_floats()->Add(values.begin(), values.end());
}

void StateWriter::put(std::string_view name, std::span<const std::int64_t> values) {
  impl_->add(name).mutable_integers()->Add(values.begin(), values.end());
}

void StateWriter::put_number(std::string_view name, double value) {
  put(name, std::span<const double>(&value, 1));
}

void StateWriter::put_integer(std::string_view name, std::uint64_t value) {
  const auto bits = std::bit_cast<std::int64_t>(value);
  put(name, std::span<const std::int64_t>(&bits, 1));
}

std::string StateWriter::bytes() const {
  proto::SealedAgentState sealed;
  sealed.set_state(impl_->state.SerializeAsString());
  sealed.set_sha256(sha256_hex(sealed.state()));
  return sealed.SerializeAsString();
}

struct StateReader::Impl {
  std::string agent_type;
  proto::AgentState state;

  const proto::NamedArray& find(std::string_view name) const {
    for (const proto::NamedArray& array : state.arrays())
      if (array.name() == name) return array;
    refuse_state(agent_type, fmt::format("field '{}' is missing", name));
  }

  template <typename T>
  void copy(std::string_view name, std::span<const T> stored, std::span<T> values) const {
    if (stored.size() != values.size())
      refuse_state(agent_type,
                   fmt::format("field '{}' has {} values where {} are needed", name, stored.size(), values.size()));
    std::ranges::copy(stored, values.begin());
  }
};

StateReader::StateReader(std::string_view bytes, std::string_view agent_type, const Parameters& parameters)
    : impl_(std::make_unique<Impl>()) {
  impl_->agent_type = agent_type;
  if (bytes.empty()) refuse("it is empty");
  proto::SealedAgentState sealed;
  if (!sealed.ParseFromArray(bytes.data(), static_cast<int>(bytes.size())))
    refuse(fmt::format("its {} bytes are truncated or not an agent state", bytes.size()));
  if (sealed.sha256().empty() || !sealed.GetReflection()->GetUnknownFields(sealed).empty())
    refuse("it is truncated or has foreign content");
  if (sha256_hex(sealed.state()) != sealed.sha256()) refuse("its checksum does not match: the content was altered");
  if (!impl_->state.ParseFromString(sealed.state())) refuse("its content is not an agent state");
  const proto::AgentState& state = impl_->state;
  if (state.version() != format_version)
    refuse(fmt::format("it has format version {}, this program reads {}", state.version(), format_version));
  if (state.agent_type() != agent_type) refuse(fmt::format("it is a state of agent '{}'", state.agent_type()));
  if (state.parameters_sha256() != parameters_hash(parameters))
    refuse("it was saved by an agent with other parameters");
}

StateReader::~StateReader() = default;

std::span<const double> StateReader::doubles(std::string_view name) const {
  return as_span(impl_->find(name).doubles());
}

std::span<const float> StateReader::floats(std::string_view name) const {
  return as_span(impl_->find(name).floats());
}

std::span<const std::int64_t> StateReader::integers(std::string_view name) const {
  return as_span(impl_->find(name).integers());
}

double StateReader::number(std::string_view name) const {
  double value = 0.0;
  get(name, std::span<double>(&value, 1));
  return value;
}

std::uint64_t StateReader::integer(std::string_view name) const {
  std::int64_t value = 0;
  get(name, std::span<std::int64_t>(&value, 1));
  return std::bit_cast<std::uint64_t>(value);
}

void StateReader::get(std::string_view name, std::span<double> values) const {
  impl_->copy(name, doubles(name), values);
}

void StateReader::get(std::string_view name, std::span<float> values) const {
  impl_->copy(name, floats(name), values);
}

void StateReader::get(std::string_view name, std::span<std::int64_t> values) const {
  impl_->copy(name, integers(name), values);
}

void StateReader::refuse(std::string_view reason) const {
  refuse_state(impl_->agent_type, reason);
}

}  // namespace aloft::agents
