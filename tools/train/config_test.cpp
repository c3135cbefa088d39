#include "tools/train/config.hpp"

#include <catch2/catch.hpp>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "common/base/error.hpp"

using namespace aloft;
using Catch::Contains;

namespace {

const std::filesystem::path file = std::filesystem::temp_directory_path() / "aloft_train_config_test.json";

train::Config read(const std::string& text) {
  std::ofstream(file) << text;
  return train::read_config(file);
}

std::string refusal(const std::string& text) {
  try {
    (void)read(text);
  } catch (const InputError& error) {
    return error.what();
  }
  return "accepted";
}

}  // namespace

TEST_CASE("a training configuration fills in defaults and keeps what is given") {
  const train::Config config = read(R"({"throughput": {"worlds": 7}})");
  CHECK(config.throughput.integer("worlds") == 7);
  CHECK(config.spectral_efficiency.integer("seed") == 7'001);
  CHECK(config.canonical()["throughput"]["worlds"] == 7);
  CHECK(config.canonical()["spectral_efficiency"]["rollout_steps"] == 20);
}

TEST_CASE("a bad training configuration is refused with file, key and range") {
  CHECK_THAT(refusal("{"), Contains(file.string()) && Contains("line 1, column 2: not valid JSON"));
  CHECK_THAT(refusal("[]"), Contains("must be a JSON object"));
  CHECK_THAT(refusal(R"({"latency": {}})"), Contains("unknown key \"latency\"") && Contains("spectral_efficiency"));
  CHECK_THAT(refusal(R"({"throughput": {"wrlds": 3}})"), Contains("wrlds") && Contains("worlds"));
  CHECK_THAT(refusal(R"({"throughput": {"worlds": 0}})"), Contains("worlds") && Contains("1"));
  std::filesystem::remove(file);
  CHECK_THROWS_AS(train::read_config(file), InputError);
}
