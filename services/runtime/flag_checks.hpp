#pragma once

#include <CLI/App.hpp>
#include <CLI/Validators.hpp>
#include <cstdint>

/// Checks of values on command lines, for every program. (CLI11's own ranges let "nan" pass, cut what is too large for
/// its type, and read "-1" as the largest unsigned number.)
namespace aloft::runtime {

[[nodiscard]] CLI::Validator whole_number(std::uint64_t lowest, std::uint64_t highest);

/// Neither "nan" nor infinite.
[[nodiscard]] CLI::Validator number(double lowest, double highest);

/// Of a run or a worker: bus::name_objection.
[[nodiscard]] CLI::Validator bus_name();

}  // namespace aloft::runtime
