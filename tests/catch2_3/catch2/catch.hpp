#pragma once

// The header of Catch2 2, made from Catch2 3: cmake/AloftOptions.cmake puts it on the path only where that is the
// installed one. Tests name matchers as Catch::X: Catch2 3 has another Catch::Matchers::Contains, for elements.

#include <catch2/catch_all.hpp>

using Catch::Approx;

namespace Catch {

inline auto Contains(const std::string& part) {
  return Matchers::ContainsSubstring(part);
}

using Matchers::EndsWith;
using Matchers::Matches;
using Matchers::StartsWith;

}  // namespace Catch
