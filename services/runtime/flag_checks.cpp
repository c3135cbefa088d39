#include "services/runtime/flag_checks.hpp"

#include <fmt/format.h>

#include "common/base/number_text.hpp"
#include "common/base/plain_text.hpp"
#include "common/bus/participant.hpp"

namespace aloft::runtime {
namespace {

std::string refusal(const std::string& text, const std::string& allowed) {
  return fmt::format("'{}' is not allowed; use {}", excerpt(text), allowed);
}

}  // namespace

CLI::Validator whole_number(std::uint64_t lowest, std::uint64_t highest) {
  const std::string range = fmt::format("{} to {}", lowest, highest);
  const auto check = [=](const std::string& text) {
    const auto value = number_in<std::uint64_t>(text);
    return value && *value >= lowest && *value <= highest ? "" : refusal(text, "a whole number from " + range);
  };
  return {check, range};
}

CLI::Validator number(double lowest, double highest) {
  const std::string range = fmt::format("{:.10g} to {:.10g}", lowest, highest);
  const auto check = [=](const std::string& text) {
    const auto value = number_in<double>(text);
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
