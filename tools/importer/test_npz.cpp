#include "tools/importer/test_npz.hpp"

#include <zip.h>

#include <cstring>
#include <stdexcept>

namespace aloft::importer::test {
namespace {

template <class Number>
std::string bytes_in_memory(const std::vector<Number>& values) {
  std::string bytes(values.size() * sizeof(Number), '\0');
  std::memcpy(bytes.data(), values.data(), bytes.size());
  return bytes;
}

void require(bool done) {
  if (!done) throw std::logic_error("libzip cannot make a test's archive");
}

}  // namespace

std::string npy(const std::string& type, const std::string& shape, const std::string& elements,
                const std::string& fortran_order) {
  std::string header = "{'descr': '" + type + "', 'fortran_order': " + fortran_order + ", 'shape': " + shape + ", }\n";
  const std::string length{static_cast<char>(header.size() % 256), static_cast<char>(header.size() / 256)};
  return std::string("\x93NUMPY\x01\x00", 8) + length + header + elements;
}

std::string bytes_of(const std::vector<double>& values) {
  return bytes_in_memory(values);
}
std::string bytes_of(const std::vector<float>& values) {
  return bytes_in_memory(values);
}
std::string bytes_of(const std::vector<std::int32_t>& values) {
  return bytes_in_memory(values);
}
std::string bytes_of(const std::vector<std::int64_t>& values) {
  return bytes_in_memory(values);
}

std::string npz(const std::vector<std::pair<std::string, std::string>>& members) {
  zip_source_t* file = zip_source_buffer_create(nullptr, 0, 0, nullptr);
  require(file != nullptr);
  zip_source_keep(file);  // zip_close() gives it away
  zip_t* archive = zip_open_from_source(file, ZIP_TRUNCATE, nullptr);
  require(archive != nullptr);
  for (const auto& [name, content] : members) {
    zip_source_t* source = zip_source_buffer(archive, content.data(), content.size(), 0);
    const zip_int64_t index = source == nullptr ? -1 : zip_file_add(archive, name.c_str(), source, 0);
    require(index >= 0 &&
            zip_set_file_compression(archive, static_cast<zip_uint64_t>(index), ZIP_CM_STORE, 0) == 0);  // as savez
  }
  require(zip_close(archive) == 0 && zip_source_open(file) == 0);
  std::string bytes;
  char part[4096];
  for (zip_int64_t count = 0; (count = zip_source_read(file, part, sizeof part)) > 0;)
    bytes.append(part, static_cast<std::size_t>(count));
  zip_source_close(file);
  zip_source_free(file);
  return bytes;
}

std::vector<std::pair<std::string, std::string>> small_map() {
  std::vector<float> power_dbm;
  for (const int cell : {0, 1})
    for (const float z_m : {20.0F, 30.0F})
      for (const float y_m : {0.0F, 10.0F})
        for (const float x_m : {0.0F, 10.0F, 20.0F}) power_dbm.push_back(cell == 0 ? -60.0F + x_m - y_m : -80.0F + z_m);
  return {{"power_dbm.npy", npy("<f4", "(2, 2, 2, 3)", bytes_of(power_dbm))},
          {"x.npy", npy("<f8", "(3,)", bytes_of(std::vector<double>{0, 10, 20}))},
          {"y.npy", npy("<i8", "(2,)", bytes_of(std::vector<std::int64_t>{0, 10}))},
          {"z.npy", npy("<f8", "(2,)", bytes_of(std::vector<double>{20, 30}))}};
}

}  // namespace aloft::importer::test
