#include "common/agents/state_archive.hpp"

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "common/base/error.hpp"

using aloft::IntegrityError;
using aloft::agents::StateReader;
using aloft::agents::StateWriter;

namespace {

const std::vector<aloft::ParameterSpec> table{aloft::number_parameter("alpha", 0.2, 0, 1, "Rate.")};
const aloft::Parameters parameters(table);

std::string sample() {
  StateWriter writer("sample", parameters);
  writer.put("values", std::vector<double>{1.5, -0.0, 1e300});
  writer.put("weights", std::vector<float>{0.1F, 2.0F});
  writer.put("counts", std::vector<std::int64_t>{-3, 0, 7});
  writer.put("empty", std::span<const double>());
  writer.put_number("epsilon", 0.1);
  writer.put_integer("position", 0xFFFFFFFFFFFFFFF0U);
  return writer.bytes();
}

std::string reason_of(const std::string& bytes, const std::string& type = "sample",
                      const aloft::Parameters& with = parameters) {
  try {
    const StateReader reader(bytes, type, with);
  } catch (const IntegrityError& error) {
    return error.what();
  }
  return "accepted";
}

}  // namespace

TEST_CASE("a state returns every field that was put into it") {
  const StateReader reader(sample(), "sample", parameters);
  const auto values = reader.doubles("values");
  CHECK(std::vector<double>(values.begin(), values.end()) == std::vector<double>{1.5, -0.0, 1e300});
  CHECK(reader.floats("weights")[0] == 0.1F);
  CHECK(reader.integers("counts")[0] == -3);
  CHECK(reader.doubles("empty").empty());
  CHECK(reader.number("epsilon") == 0.1);
  CHECK(reader.integer("position") == 0xFFFFFFFFFFFFFFF0U);
  std::vector<float> weights(2);
  reader.get("weights", weights);
  CHECK(weights == std::vector<float>{0.1F, 2.0F});
  CHECK(sample() == sample());
}

TEST_CASE("a state that is cut at any byte, or has any bit flipped, is refused with a hint") {
  const std::string whole = sample();
  const auto check_refused = [](const std::string& damaged) {
    CHECK_THAT(reason_of(damaged), Catch::Contains("start it afresh or from another checkpoint"));
  };
  for (std::size_t size = 0; size < whole.size(); ++size) {
    INFO("cut to " << size << " bytes");
    check_refused(whole.substr(0, size));
  }
  for (std::size_t bit = 0; bit < whole.size() * 8; ++bit) {
    INFO("bit " << bit);
    std::string altered = whole;
    altered[bit / 8] = static_cast<char>(altered[bit / 8] ^ (1 << (bit % 8)));
    check_refused(altered);
  }
  check_refused(whole + whole.substr(0, 2));
}

TEST_CASE("a refused state says why") {
  using Catch::Contains;
  CHECK_THAT(reason_of(""), Contains("it is empty"));
  CHECK_THAT(reason_of(sample(), "other"), Contains("it is a state of agent 'sample'"));
  const aloft::Parameters changed(table, nlohmann::json{{"alpha", 0.3}}, "agents[0]");
  CHECK_THAT(reason_of(sample(), "sample", changed), Contains("other parameters"));
  std::string altered = sample();
  altered[altered.size() / 2] ^= 1;
  CHECK_THAT(reason_of(altered), Contains("checksum"));

  const StateReader reader(sample(), "sample", parameters);
  CHECK_THROWS_WITH(reader.number("missing"), Contains("field 'missing' is missing"));
  std::vector<double> two(2);
  CHECK_THROWS_WITH(reader.get("values", two), Contains("field 'values' has 3 values where 2 are needed"));
}

TEST_CASE("writing a field twice is a bug") {
  StateWriter writer("sample", parameters);
  writer.put_number("epsilon", 1);
  CHECK_THROWS_AS(writer.put_number("epsilon", 1), std::logic_error);
}
