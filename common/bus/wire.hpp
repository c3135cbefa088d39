#pragma once

#include <cstdint>
#include <idl/types.hpp>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include "common/base/limits.hpp"

/// The types on the wire (idl/*.idl), their text fields, and nothing of the middleware behind them.
namespace aloft::wire {

using Name = std::remove_cvref_t<decltype(AgentName().text())>;
using Message = std::remove_cvref_t<decltype(RunStatus().message())>;
using ExperimentId = std::remove_cvref_t<decltype(RunControl().experiment_id())>;
static_assert(Name::max_size == limits::name_bytes && Message::max_size == limits::message_bytes);

// fastddsgen makes scoped enumerations in one generation and unscoped ones in the other: both are wire::ACTION_UP here.
using enum Action;
using enum AgentState;
using enum AntennaKind;
using enum CollectorState;
using enum Privilege;
using enum QosKind;
using enum RunState;
using enum WorldKind;

/// For names and ids, which must arrive whole: std::length_error if `text` is longer than the field.
[[nodiscard]] Name name(std::string_view text);
[[nodiscard]] ExperimentId experiment_id(std::string_view text);
/// For messages to people: cut between characters, if they are longer than the field.
[[nodiscard]] Message message(std::string_view text);

template <class Text>
[[nodiscard]] std::string_view view(const Text& text) noexcept {
  return text.c_str();
}

[[nodiscard]] std::vector<AgentName> names(const std::vector<std::string>& texts);
[[nodiscard]] std::vector<std::string> texts(const std::vector<AgentName>& names);

[[nodiscard]] std::vector<std::uint8_t> bytes(std::string_view text);
[[nodiscard]] std::string_view view(const std::vector<std::uint8_t>& bytes) noexcept;

}  // namespace aloft::wire
