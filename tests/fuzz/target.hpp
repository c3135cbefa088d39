#pragma once

#include <cstddef>
#include <cstdint>
#include <stdexcept>
#include <string_view>

#include "common/base/error.hpp"

/// What a fuzz target runs on one input. The program crashes if it finds a fault: an exception that escapes, or
/// whatever the sanitizers stop.
// NOLINTNEXTLINE(readability-identifier-naming): libFuzzer's name
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);

namespace aloft::fuzz {

[[nodiscard]] inline std::string_view text(const std::uint8_t* data, std::size_t size) noexcept {
  return {reinterpret_cast<const char*>(data), size};
}

/// Something that holds for every input, or else a fault was found.
inline void require(bool holds, const char* what) {
  if (!holds) throw std::logic_error(what);
}

/// False if the input was refused in the way that callers expect; other exceptions are faults.
template <class Read>
bool accepted(Read&& read) {
  try {
    read();
    return true;
  } catch (const InputError&) {
  } catch (const IntegrityError&) {
  }
  return false;
}

}  // namespace aloft::fuzz
