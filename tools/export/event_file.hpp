#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace aloft::exports {

/// A value of a curve, by the curve's name.
using Scalars = std::vector<std::pair<std::string, double>>;

/// An event file as TensorBoard reads it: curves over steps. Values become 32-bit floats.
class EventFile {
 public:
  EventFile();

  void add(double time_s, std::int64_t step, const Scalars& scalars);

  [[nodiscard]] const std::string& bytes() const noexcept { return bytes_; }

 private:
  /// Appends a record as TensorFlow frames it: the length, the content, and a checksum of each.
  void add_record(std::string_view content);

  std::string bytes_;
};

}  // namespace aloft::exports
