#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

// Arrays and files of NumPy for tests, written byte by byte after NumPy's description of the NPY format.
namespace aloft::importer::test {

/// An NPY file (version 1). `type` as in "<f8"; the header is made of the texts as they are.
[[nodiscard]] std::string npy(const std::string& type, const std::string& shape, const std::string& elements,
                              const std::string& fortran_order = "False");

/// Elements as they stand in memory.
[[nodiscard]] std::string bytes_of(const std::vector<double>& values);
[[nodiscard]] std::string bytes_of(const std::vector<float>& values);
[[nodiscard]] std::string bytes_of(const std::vector<std::int32_t>& values);
[[nodiscard]] std::string bytes_of(const std::vector<std::int64_t>& values);

/// An NPZ file with these members: names, with ".npy", and content.
[[nodiscard]] std::string npz(const std::vector<std::pair<std::string, std::string>>& members);

/// A radio map with two cells at x = 0, 10, 20, y = 0, 10 and z = 20, 30 m. The first cell gives -60 dBm + x - y, the
/// second -80 dBm + z.
[[nodiscard]] std::vector<std::pair<std::string, std::string>> small_map();

}  // namespace aloft::importer::test
