#pragma once

#include <algorithm>
#include <idl/type_supports.hpp>
#include <memory>
#include <span>

#include "common/bus/convert.hpp"
#include "common/bus/detail.hpp"
#include "common/bus/validate.hpp"

namespace aloft::fuzz {

/// What processes make of the samples that they accept.
template <class T>
void use(const T& /*sample*/) {}
inline void use(const wire::ChannelReport& report) {
  (void)bus::flight_info(report);
  (void)bus::observation(report);
}
inline void use(const wire::HeightCommand& message) {
  if (message.action() != wire::ACTION_UNKNOWN_FLIGHT) (void)bus::command(message);
}
inline void use(const wire::HeightProfile& message) {
  (void)bus::profile(message);
}
inline void use(const wire::World& message) {
  (void)bus::city(message);
  (void)bus::measured_world(message);
}

/// As a bus::Reader does with a payload that has arrived. Whether it was accepted.
template <class T, class Generated>
bool receive_as(std::span<const std::uint8_t> bytes) {
  static bus::DropCounter drops(bus::topic_settings<T>().name);
  static bus::CheckedType<Generated> type(drops);
  bus::rtps::SerializedPayload_t payload(static_cast<std::uint32_t>(bytes.size()));
  std::copy(bytes.begin(), bytes.end(), payload.data);
  payload.length = static_cast<std::uint32_t>(bytes.size());
  const auto sample = std::make_unique<T>();
  if (!type.from_bytes(payload, sample.get()) || bus::validate(*sample) != nullptr) return false;
  use(*sample);
  return true;
}

using Receive = bool (*)(std::span<const std::uint8_t>);

/// One function per topic, in the order of topics.def.
inline constexpr Receive receivers[] = {
#define ALOFT_TOPIC(type, ...) receive_as<wire::type, wire::type##PubSubType>,
#include "common/bus/topics.def"
};

}  // namespace aloft::fuzz
