#include "common/bus/wire.hpp"

#include <fmt/format.h>

#include <stdexcept>

#include "common/base/plain_text.hpp"

namespace aloft::wire {
namespace {

template <class Field>
Field whole(std::string_view text) {
  if (text.size() > Field::max_size)
    throw std::length_error(fmt::format("'{}' has {} bytes; names on the wire have at most {}",
                                        plain_text(text, Field::max_size), text.size(), Field::max_size));
  return Field(std::string(text));
}

}  // namespace

Name name(std::string_view text) {
  return whole<Name>(text);
}

ExperimentId experiment_id(std::string_view text) {
  return whole<ExperimentId>(text);
}

Message message(std::string_view text) {
  return Message(std::string(beginning_of(text, limits::message_bytes)));
}

std::vector<AgentName> names(const std::vector<std::string>& texts) {
  std::vector<AgentName> result(texts.size());
  for (std::size_t i = 0; i < texts.size(); ++i) result[i].text(name(texts[i]));
  return result;
}

std::vector<std::string> texts(const std::vector<AgentName>& names) {
  std::vector<std::string> result;
  result.reserve(names.size());
  for (const AgentName& one : names) result.emplace_back(view(one.text()));
  return result;
}

std::vector<std::uint8_t> bytes(std::string_view text) {
  return {text.begin(), text.end()};
}

std::string_view view(const std::vector<std::uint8_t>& bytes) noexcept {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

}  // namespace aloft::wire
