#include "services/runtime/flag_checks.hpp"

#include <fmt/format.h>

#include <charconv>
#include <cmath>
#include <optional>

#include "common/base/plain_text.hpp"
#include "common/bus/participant.hpp"

namespace aloft::runtime {
namespace {

template <typename Number>
std::optional<Number> parsed(const std::string& text) {
  Number value{};
  const char* const end = text.data() + text.size();
  if (std::from_chars(text.data(), end, value) != std::from_chars_result{end, std::errc()}) return std::nullopt;
  return value;
}

std::string refusal(const std::string& text, const std::string& allowed) {
  return fmt::format("'{}' is not allowed; use {}", excerpt(text), allowed);
}

}  // namespace

CLI::Validator whole_number(std::uint64_t lowest, std::uint64_t highest) {
  const std::string range = fmt::format("{} to {}", lowest, highest);
  const auto check = [=](const std::string& text) {
    const auto value = parsed<std::uint64_t>(text);
    return value && *value >= lowest && *value <= highest ? "" : refusal(text, "a whole number from " + range);
  };
  return {check, range};
}

CLI::Validator number(double lowest, double highest) {
  const std::string range = fmt::format("{:.10g} to {:.10g}", lowest, highest);
  const auto check = [=](const std::string& text) {
    const auto value = parsed<double>(text);
    return value && *value >= lowest && *value <= highest ? "" : refusal(text, "a number from " + range);
  };
  return {check, range};
}

CLI::Validator bus_name() {
  const auto check = [](const std::string& text) {
    const std::string objection = bus::name_objection(text);
    return objection.empty() ? "" : refusal(text, objection);
  };
  return {check, "NAME"};
}

}  // namespace aloft::runtime
