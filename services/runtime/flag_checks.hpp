#pragma once

#include <CLI/App.hpp>
#include <CLI/Validators.hpp>
#include <cstdint>

/// Checks of values on command lines, for every program. (CLI11's own ranges accept "nan", truncate numbers that are
/// too large for their type, and read "-1" as the largest unsigned number.)
namespace aloft::runtime {

[[nodiscard]] CLI::Validator whole_number(std::uint64_t lowest, std::uint64_t highest);

/// A finite number in this range.
[[nodiscard]] CLI::Validator number(double lowest, double highest);

/// The name of a run or a worker: see bus::name_objection.
[[nodiscard]] CLI::Validator bus_name();

}  // namespace aloft::runtime
