#pragma once

#include <cstdint>
#include <cstdio>
#include <span>

#include "common/store/result_store.hpp"

namespace aloft::exports {

enum class Rows : std::uint8_t { flights, steps };
enum class RowFormat : std::uint8_t { csv, json };

/// Prints one row per flight, or per step of each flight, with the same columns as in the Python package: a CSV with a
/// header line, or a JSON array with one object per line. Throws IntegrityError as ResultStore::trace().
void write_rows(const store::ResultStore& results, std::span<const store::FlightSummary> flights, Rows what,
                RowFormat format, std::FILE* out);

}  // namespace aloft::exports
