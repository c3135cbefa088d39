#include "tools/importer/test_workspace.hpp"

#include <zlib.h>

#include <algorithm>
#include <bit>
#include <fstream>
#include <stdexcept>

namespace aloft::importer::test {
namespace {

void put(std::string& bytes, std::uint32_t word) {
  for (int shift = 24; shift >= 0; shift -= 8) bytes += static_cast<char>(word >> static_cast<unsigned>(shift) & 0xFFU);
}

void put(std::string& bytes, double value) {
  const auto word = std::bit_cast<std::uint64_t>(value);
  put(bytes, static_cast<std::uint32_t>(word >> 32U));
  put(bytes, static_cast<std::uint32_t>(word));
}

void put(std::string& bytes, const std::vector<double>& values) {
  put(bytes, 14U);  // REALSXP
  put(bytes, static_cast<std::uint32_t>(values.size()));
  for (const double value : values) put(bytes, value);
}

void put(std::string& bytes, const std::vector<std::int32_t>& values) {
  put(bytes, 13U);  // INTSXP
  put(bytes, static_cast<std::uint32_t>(values.size()));
  for (const std::int32_t value : values) put(bytes, static_cast<std::uint32_t>(value));
}

/// Another form of a vector: class, package and type, then its content.
std::string alternative(const std::string& name, const std::string& class_name) {
  const std::string package = "base";
  std::string bytes = xdr_head(name) + xdr({238, 2, 1, 0x40009, static_cast<std::uint32_t>(class_name.size())});
  bytes += class_name + xdr({2, 1, 0x40009, static_cast<std::uint32_t>(package.size())}) + package;
  return bytes + xdr({2, 13, 1, 14, 254});
}

}  // namespace

std::string xdr(std::initializer_list<std::uint32_t> words) {
  std::string bytes;
  for (const std::uint32_t word : words) put(bytes, word);
  return bytes;
}

std::string xdr_head(const std::string& name) {
  // A pair with a tag, which is a symbol, whose name is an ASCII text.
  return xdr({0x402, 1, 0x40009, static_cast<std::uint32_t>(name.size())}) + name;
}

std::string sequence(double length) {
  std::string bytes = alternative("sequence", "compact_intseq");
  put(bytes, std::vector<double>{length, 1.0, 2.0});
  return bytes + xdr({254});
}

std::string wrapped(const std::vector<double>& values) {
  std::string bytes = alternative("wrapped", "wrap_real") + xdr({2});
  put(bytes, values);
  bytes += xdr({2});
  put(bytes, std::vector<std::int32_t>{0, 0});
  return bytes + xdr({254, 254});
}

std::string xdr_workspace(const std::vector<Object>& objects, const std::string& more) {
  std::string bytes = "RDX2\nX\n";
  put(bytes, 2U);         // format version
  put(bytes, 0x030603U);  // written by R 3.6.3
  put(bytes, 0x020300U);  // readable since R 2.3.0
  for (const Object& object : objects) {
    bytes += xdr_head(object.name);
    if (object.in_list) {
      put(bytes, 19U);  // VECSXP
      put(bytes, 1U);
    }
    std::visit([&](const auto& values) { put(bytes, values); }, object.values);
  }
  bytes += more;
  put(bytes, 254U);  // NILVALUE_SXP
  return bytes;
}

std::string gzip(const std::string& bytes) {
  z_stream stream{};
  if (deflateInit2(&stream, Z_DEFAULT_COMPRESSION, Z_DEFLATED, 16 + MAX_WBITS, 8, Z_DEFAULT_STRATEGY) != Z_OK)
    throw std::runtime_error("zlib");
  std::string input = bytes;
  std::string packed(deflateBound(&stream, static_cast<uLong>(bytes.size())), '\0');
  stream.next_in = reinterpret_cast<Bytef*>(input.data());
  stream.avail_in = static_cast<uInt>(input.size());
  stream.next_out = reinterpret_cast<Bytef*>(packed.data());
  stream.avail_out = static_cast<uInt>(packed.size());
  const int status = deflate(&stream, Z_FINISH);
  packed.resize(stream.total_out);
  deflateEnd(&stream);
  if (status != Z_STREAM_END) throw std::runtime_error("zlib");
  return packed;
}

void write_bytes(const std::filesystem::path& file, const std::string& bytes) {
  std::ofstream(file, std::ios::binary) << bytes;
}

NumericVectors Recorder::record(const std::vector<std::vector<std::uint32_t>>& flights) const {
  std::vector<double> throughput;
  std::vector<double> level;
  std::vector<double> maxima;
  for (const std::vector<std::uint32_t>& flight : flights) {
    for (std::size_t step = 0; step < steps; ++step) {
      const auto row = truth.begin() + static_cast<std::ptrdiff_t>(step * heights);
      level.push_back(flight.at(step));
      throughput.push_back(row[flight.at(step) - 1]);
      maxima.push_back(*std::max_element(row, row + heights));
    }
    maxima.push_back(0.0);  // one value more than steps
  }
  NumericVectors vectors;
  for (const std::string agent : {"", "rand", "const", "const1", "const2", "max"}) {
    vectors[agent.empty() ? "achieveableRate" : agent + "AchieveableRate"] = throughput;
    vectors[agent + "height"] = level;
  }
  vectors["optmAchieveableRate"] = maxima;
  return vectors;
}

std::vector<Object> objects(const NumericVectors& vectors) {
  std::vector<Object> all{{"history1", std::vector<double>{0.5, 0.25}, true}};
  for (const auto& [name, values] : vectors) all.push_back({name, values});
  return all;
}

Recorder north_wall_quay_like() {
  Recorder recorder{160, 10, {}};
  for (std::uint32_t cell = 0; cell < 1600; ++cell) recorder.truth.push_back(20000.0 + (cell * 7919U % 30000U) + 0.5);
  return recorder;
}

std::vector<std::vector<std::uint32_t>> one_flight_per_level(const Recorder& recorder) {
  std::vector<std::vector<std::uint32_t>> flights;
  for (std::uint32_t level = 1; level <= recorder.heights; ++level) flights.emplace_back(recorder.steps, level);
  return flights;
}

}  // namespace aloft::importer::test
