#pragma once

#include <idl/control.h>
#include <idl/flight.h>
#include <idl/record.h>
#include <idl/world.h>

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "common/base/limits.hpp"

/// The types on the wire (idl/*.idl), their text fields, and nothing of the middleware behind them.
namespace aloft::wire {

using Name = eprosima::fastrtps::fixed_string<limits::name_bytes>;
using Message = eprosima::fastrtps::fixed_string<limits::message_bytes>;
using ExperimentId = eprosima::fastrtps::fixed_string<16>;

/// For names and ids, which must arrive whole: std::length_error if `text` is longer than the field.
[[nodiscard]] Name name(std::string_view text);
[[nodiscard]] ExperimentId experiment_id(std::string_view text);
/// For messages to people: cut between characters, if they are longer than the field.
[[nodiscard]] Message message(std::string_view text);

template <std::size_t N>
[[nodiscard]] std::string_view view(const eprosima::fastrtps::fixed_string<N>& text) noexcept {
  return text.c_str();
}

[[nodiscard]] std::vector<AgentName> names(const std::vector<std::string>& texts);
[[nodiscard]] std::vector<std::string> texts(const std::vector<AgentName>& names);

[[nodiscard]] std::vector<std::uint8_t> bytes(std::string_view text);
[[nodiscard]] std::string_view view(const std::vector<std::uint8_t>& bytes) noexcept;

}  // namespace aloft::wire
