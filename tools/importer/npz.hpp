#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace aloft::importer {

/// Of all arrays of a file together.
inline constexpr std::size_t most_array_bytes = std::size_t{512} << 20U;

/// An array of NumPy: real or whole numbers, of which any is a double.
class NpyArray {
 public:
  /// Content of an NPY file (versions 1 to 3), little-endian float32, float64, int32 or int64, in C or Fortran order.
  /// InputError "name: reason".
  NpyArray(std::string bytes, std::string name);

  [[nodiscard]] const std::string& name() const noexcept { return name_; }
  [[nodiscard]] const std::vector<std::size_t>& shape() const noexcept { return shape_; }
  [[nodiscard]] std::size_t size() const noexcept { return size_; }
  /// The element at `index`, which counts in C order.
  [[nodiscard]] double operator[](std::size_t index) const;

 private:
  void read_header(std::string_view header);
  void read_shape(std::string_view tuple);

  std::string bytes_;
  std::string name_;
  std::size_t begin_ = 0;  // of the elements in bytes_
  char kind_ = 'f';        // 'f' or 'i'
  std::size_t width_ = 0;  // of an element, bytes
  bool fortran_order_ = false;
  std::vector<std::size_t> shape_;
  std::size_t size_ = 0;
};

/// The arrays of an NPZ file (numpy.savez, numpy.savez_compressed): their names are those of the file's members without
/// ".npy". InputError "name: reason" if it is no ZIP archive, has more than 64 members, expands to more than
/// `most_bytes`, or if a member is damaged.
class NpzFile {
 public:
  NpzFile(std::string_view bytes, std::string name, std::size_t most_bytes = most_array_bytes);

  [[nodiscard]] bool has(std::string_view array) const;
  /// InputError if it is not there.
  [[nodiscard]] NpyArray array(std::string_view array) const;

 private:
  struct Member {
    std::string name;
    std::string bytes;
  };
  std::string name_;
  std::vector<Member> members_;
};

}  // namespace aloft::importer
