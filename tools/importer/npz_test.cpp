#include "tools/importer/npz.hpp"

#include <catch2/catch.hpp>

#include "common/base/error.hpp"
#include "common/base/read_file.hpp"
#include "tests/paths.hpp"
#include "tools/importer/test_npz.hpp"

using namespace aloft;
using namespace aloft::importer;
using namespace aloft::importer::test;
using Catch::Contains;

namespace {

std::string npy_error(const std::string& bytes) {
  try {
    static_cast<void>(NpyArray(bytes, "array"));
  } catch (const InputError& error) {
    return error.what();
  }
  return "accepted";
}

std::string npz_error(const std::string& bytes) {
  try {
    static_cast<void>(NpzFile(bytes, "map.npz").array("x"));
  } catch (const InputError& error) {
    return error.what();
  }
  return "accepted";
}

const std::string two_doubles = bytes_of(std::vector<double>{1.5, -2.0});

}  // namespace

TEST_CASE("arrays of NumPy give their elements in C order, whatever their type and order") {
  const NpyArray doubles(npy("<f8", "(2,)", two_doubles), "a");
  CHECK(doubles.shape() == std::vector<std::size_t>{2});
  CHECK(doubles[0] == 1.5);
  CHECK(doubles[1] == -2.0);
  const NpyArray whole(npy("<i4", "(1, 3)", bytes_of(std::vector<std::int32_t>{7, -8, 9})), "a");
  CHECK(whole.shape() == std::vector<std::size_t>{1, 3});
  CHECK(whole[1] == -8.0);
  CHECK(NpyArray(npy("<i8", "(1,)", bytes_of(std::vector<std::int64_t>{1LL << 40})), "a")[0] == 1099511627776.0);

  // [[1, 2, 3], [4, 5, 6]], stored column after column.
  const NpyArray columns(npy("<f4", "(2, 3)", bytes_of(std::vector<float>{1, 4, 2, 5, 3, 6}), "True"), "a");
  for (std::size_t i = 0; i < 6; ++i) CHECK(columns[i] == static_cast<double>(i + 1));

  std::string version_2 = npy("<f8", "(2,)", two_doubles);
  version_2[6] = 2;
  version_2.insert(10, 2, '\0');  // the length of the header has four bytes
  CHECK(NpyArray(version_2, "a")[1] == -2.0);
}

TEST_CASE("other and damaged arrays are refused by name and reason") {
  CHECK_THAT(npy_error("no array"), Contains("array: this is no array of NumPy"));
  CHECK_THAT(npy_error(""), Contains("this is no array of NumPy"));
  const std::string good = npy("<f8", "(2,)", two_doubles);
  CHECK(npy_error(good) == "accepted");
  CHECK_THAT(npy_error(good.substr(0, 20)), Contains("ends within its header"));
  CHECK_THAT(npy_error(good.substr(0, good.size() - 1)), Contains("has 15 bytes of elements, but its shape (2) means"));
  CHECK_THAT(npy_error(good + "x"), Contains("has 17 bytes"));
  CHECK_THAT(npy_error(npy(">f8", "(2,)", two_doubles)), Contains("'>f8'") && Contains("astype"));
  CHECK_THAT(npy_error(npy("<c16", "(1,)", two_doubles)), Contains("'<c16'"));
  CHECK_THAT(npy_error(npy("|O", "(2,)", two_doubles)), Contains("'|O'"));
  CHECK_THAT(npy_error(npy("<f8", "(0,)", "")), Contains("shape (0,)") && Contains("1 at least"));
  CHECK_THAT(npy_error(npy("<f8", "(18446744073709551615, 2)", "")), Contains("at most"));
  CHECK_THAT(npy_error(npy("<f8", "(99999999999999999999999,)", "")), Contains("at most"));
  std::string keyless = good;
  keyless.replace(keyless.find("shape"), 5, "shaqe");
  CHECK_THAT(npy_error(keyless), Contains("descr, fortran_order and shape"));
}

TEST_CASE("an NPZ file gives its arrays by name") {
  const std::string file =
      npz({{"x.npy", npy("<f8", "(2,)", two_doubles)}, {"power_dbm.npy", npy("<f8", "(1,)", two_doubles.substr(8))}});
  const NpzFile arrays(file, "map.npz");
  CHECK(arrays.has("x"));
  CHECK_FALSE(arrays.has("y"));
  CHECK(arrays.array("x")[0] == 1.5);
  CHECK(arrays.array("power_dbm")[0] == -2.0);
  CHECK_THROWS_WITH(arrays.array("power_db"), Contains("map.npz: has no array 'power_db'") &&
                                                  Contains("Did you mean 'power_dbm'") && Contains("x, power_dbm"));
}

TEST_CASE("files that are no NPZ files are refused") {
  CHECK_THAT(npz_error("PK"), Contains("map.npz: this is no NPZ file"));
  CHECK_THAT(npz_error(""), Contains("map.npz: this is no NPZ file"));
  const std::string good = npz({{"x.npy", npy("<f8", "(2,)", two_doubles)}});
  CHECK(npz_error(good) == "accepted");
  CHECK_THAT(npz_error(good.substr(0, good.size() / 2)), Contains("no NPZ file"));
  std::string damaged = good;
  damaged[damaged.find(two_doubles)] ^= 1;  // found by the archive's checksum
  CHECK_THAT(npz_error(damaged), Contains("map.npz: x.npy: is damaged"));
  CHECK_THAT(npz_error(npz(std::vector<std::pair<std::string, std::string>>(1, {"x.npy", "text"}))),
             Contains("map.npz: x: this is no array"));
  std::vector<std::pair<std::string, std::string>> many;
  for (int i = 0; i < 65; ++i) many.emplace_back(std::to_string(i), "");
  CHECK_THAT(npz_error(npz(many)), Contains("65 members; at most 64"));
}

TEST_CASE("the arrays of a file may take no more than their limit together") {
  const std::string array = npy("<f8", "(2,)", two_doubles);
  const std::string file = npz({{"x.npy", array}, {"y.npy", array}});
  CHECK(NpzFile(file, "map.npz", 2 * array.size()).has("y"));
  CHECK_THROWS_WITH(NpzFile(file, "map.npz", 2 * array.size() - 1),
                    Contains("map.npz: y.npy: with it") && Contains("too large"));
}

TEST_CASE("the sample, written by numpy.savez_compressed, is read") {
  const NpzFile sample(read_file(aloft::test::source_dir() / "data/samples/map_sample.npz"), "sample");
  CHECK(sample.array("power_dbm").shape() == std::vector<std::size_t>{3, 4, 6, 11});
  CHECK(sample.array("cell")[2] == 23.0);
  // 46 - 38.5 - 20 log10 of the distance from (50, 180, 25) to (0, 0, 40), 187.4 m: no walls from 40 m on
  CHECK(sample.array("power_dbm")[66] == Approx(-38.0).margin(0.051));
}
