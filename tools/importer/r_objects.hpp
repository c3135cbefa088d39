#pragma once

#include <map>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

namespace aloft::importer {

/// The numeric vectors of an R workspace, by name. A missing value (NA) is NaN.
using NumericVectors = std::map<std::string, std::vector<double>, std::less<>>;

/// Why the content of a workspace cannot be read; the message says where.
class UnreadableObjects : public std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// The numeric vectors at the top level of an unpacked workspace, versions 2 and 3 of R's serialization in XDR form
/// ("R Internals", section 1.8). All other objects are passed over. Asks for no more memory than a small multiple of
/// the bytes, whatever they say, and recurses to a limited depth. Throws UnreadableObjects.
[[nodiscard]] NumericVectors numeric_vectors(std::string_view bytes);

}  // namespace aloft::importer
