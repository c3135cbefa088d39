#include "tools/importer/r_workspace.hpp"

#include <unistd.h>

#include <catch2/catch.hpp>
#include <cmath>
#include <limits>

#include "common/base/error.hpp"
#include "tools/importer/test_workspace.hpp"

using aloft::InputError;
using aloft::importer::NumericVectors;
using aloft::importer::parse_r_workspace;
using aloft::importer::read_r_workspace;
using aloft::importer::test::gzip;
using aloft::importer::test::Object;
using aloft::importer::test::sequence;
using aloft::importer::test::wrapped;
using aloft::importer::test::write_bytes;
using aloft::importer::test::xdr;
using aloft::importer::test::xdr_head;
using aloft::importer::test::xdr_workspace;
using Catch::Contains;

namespace {

/// A file with these bytes that disappears with this object.
class File {
 public:
  explicit File(const std::string& bytes) { write_bytes(path_, bytes); }
  ~File() { std::filesystem::remove(path_); }
  File(const File&) = delete;
  File& operator=(const File&) = delete;
  [[nodiscard]] const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_ =
      std::filesystem::temp_directory_path() / ("aloft-workspace-" + std::to_string(getpid()) + ".Rdata");
};

std::string refusal(const std::string& bytes) {
  const File file(bytes);
  try {
    static_cast<void>(read_r_workspace(file.path()));
  } catch (const InputError& error) {
    CHECK_THAT(error.what(), Contains(file.path().string()));
    return error.what();
  }
  return "";
}

const std::vector<Object> small_workspace{
    {"history", std::vector<double>{1.0}, true},
    {"rate", std::vector<double>{46905.66015625, 0.1, -1e300}},
    {"level", std::vector<std::int32_t>{1, -7, std::numeric_limits<std::int32_t>::min()}},
    {"empty", std::vector<double>{}}};

}  // namespace

TEST_CASE("numeric vectors come back bit for bit, lists are passed over") {
  const File file(gzip(xdr_workspace(small_workspace)));
  const NumericVectors vectors = read_r_workspace(file.path());
  CHECK(vectors.at("rate") == std::vector<double>{46905.66015625, 0.1, -1e300});
  REQUIRE(vectors.at("level").size() == 3);
  CHECK(vectors.at("level")[0] == 1.0);
  CHECK(vectors.at("level")[1] == -7.0);
  CHECK(std::isnan(vectors.at("level")[2]));
  CHECK_FALSE(vectors.contains("history"));
}

TEST_CASE("what is no gzip file, or no R workspace inside, is refused with the reason") {
  CHECK_THAT(refusal(""), Contains("empty"));
  CHECK_THAT(refusal("step,height_m\n1,20\n"), Contains("not a gzip file") && Contains("save("));
  CHECK_THAT(refusal(xdr_workspace(small_workspace)), Contains("not a gzip file"));
  CHECK_THAT(refusal(gzip("hello")), Contains("no R workspace"));
  CHECK_THAT(refusal(gzip("")), Contains("no R workspace"));
  CHECK_THROWS_WITH(read_r_workspace("/no/such/file.Rdata"),
                    Contains("/no/such/file.Rdata") && Contains("cannot read"));
  CHECK_THROWS_WITH(read_r_workspace("/tmp"), Contains("folder"));
}

TEST_CASE("sequences that are only described, and wrapped vectors, come back as numbers") {
  const NumericVectors vectors = parse_r_workspace(gzip(xdr_workspace({}, sequence(4.0) + wrapped({2.5, 7.0}))), "x");
  CHECK(vectors.at("sequence") == std::vector<double>{1.0, 3.0, 5.0, 7.0});
  CHECK(vectors.at("wrapped") == std::vector<double>{2.5, 7.0});
  CHECK(parse_r_workspace(gzip(xdr_workspace({}, sequence(0.5))), "x").at("sequence").empty());
}

TEST_CASE("objects that R does not write are refused before they cost memory or stack") {
  for (const double length : {-1.0, 1e7, 1e18, std::nan("")})
    CHECK_THAT(refusal(gzip(xdr_workspace({}, sequence(length)))), Contains("impossible length"));
  std::string many;
  for (int i = 0; i < 3; ++i) many += sequence(500'000.0);
  CHECK_THAT(refusal(gzip(xdr_workspace({}, many))), Contains("impossible length"));
  std::string lists;
  for (int i = 0; i < 1'000'000; ++i) lists += xdr({19, 1});
  CHECK_THAT(refusal(gzip(xdr_workspace({}, xdr_head("deep") + lists))), Contains("more than 100 deep"));
  CHECK_THAT(refusal(gzip(xdr_workspace({}, xdr_head("long") + xdr({14, 0x7FFFFFFF})))),
             Contains("elements, but only"));
  CHECK_THAT(refusal(gzip(xdr_workspace({}, xdr({0x402, 0x1FF})))), Contains("reference to nothing"));
  CHECK_THAT(refusal(gzip(xdr_workspace({}, xdr_head("code") + xdr({21})))), Contains("type 21") && Contains("rm()"));
}

TEST_CASE("a workspace cut short at any byte is refused, packed or unpacked") {
  const std::string whole = xdr_workspace(small_workspace);
  const std::string packed = gzip(whole);
  for (std::size_t length = 2; length < packed.size(); ++length) {
    INFO("packed, " << length << " of " << packed.size());
    CHECK_THAT(refusal(packed.substr(0, length)), Contains("end too early") && Contains("download"));
  }
  for (std::size_t length = 7; length < whole.size(); ++length) {
    INFO("unpacked, " << length << " of " << whole.size());
    CHECK_THAT(refusal(gzip(whole.substr(0, length))), Contains("download"));
  }
}

TEST_CASE("damaged gzip data are refused") {
  std::string packed = gzip(xdr_workspace(small_workspace));
  packed[packed.size() - 6] = static_cast<char>(packed[packed.size() - 6] ^ 1);  // the checksum
  CHECK_THAT(refusal(packed), Contains("damaged"));
}
