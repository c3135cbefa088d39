#pragma once

#include <cstdint>
#include <filesystem>
#include <initializer_list>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "tools/importer/r_workspace.hpp"

// R workspaces for tests, written byte by byte after "R Internals", section 1.8 (serialization formats).
namespace aloft::importer::test {

using Vector = std::variant<std::vector<double>, std::vector<std::int32_t>>;

/// One named object of a workspace; `in_list` wraps the vector in a list, as the authors' training history is.
struct Object {
  std::string name;
  Vector values;
  bool in_list = false;
};

/// The unpacked bytes that save(version = 2) would write; `more` are the bytes of further objects.
[[nodiscard]] std::string xdr_workspace(const std::vector<Object>& objects, const std::string& more = {});

/// Words as they stand in a workspace, and what stands before an object with this name.
[[nodiscard]] std::string xdr(std::initializer_list<std::uint32_t> words);
[[nodiscard]] std::string xdr_head(const std::string& name);
/// The object "sequence" as R saves 1, 3, 5, ... that was never computed, and "wrapped", a vector in a wrapper.
[[nodiscard]] std::string sequence(double length);
[[nodiscard]] std::string wrapped(const std::vector<double>& values);

[[nodiscard]] std::string gzip(const std::string& bytes);

void write_bytes(const std::filesystem::path& file, const std::string& bytes);

/// A measured world with known values, [(step - 1) * heights + level - 1], and what flights in it record.
struct Recorder {
  std::uint32_t steps = 0;
  std::uint32_t heights = 0;
  std::vector<double> truth;

  /// The authors' vectors after every one of their six agents flew these flights (the level of each step).
  [[nodiscard]] NumericVectors record(const std::vector<std::vector<std::uint32_t>>& flights) const;
};

/// All of `vectors` as objects of one workspace.
[[nodiscard]] std::vector<Object> objects(const NumericVectors& vectors);

/// 160 steps, 10 levels, as the North Wall Quay flight is. Every level is flown by one constant flight.
[[nodiscard]] Recorder north_wall_quay_like();
[[nodiscard]] std::vector<std::vector<std::uint32_t>> one_flight_per_level(const Recorder& recorder);

}  // namespace aloft::importer::test
