#include "common/agents/pretrained_model.hpp"

#include <idl/model.pb.h>

#include <catch2/catch.hpp>

#include "common/base/digest.hpp"
#include "common/base/error.hpp"

using namespace aloft;
using namespace aloft::agents;
using Catch::Contains;

namespace {

PretrainedModel small_model() {
  PretrainedModel model;
  for (auto* network : {&model.spectral_efficiency, &model.throughput}) {
    network->hidden_width = 2;
    network->weights.assign(2 * 84 + 2 * 3 + 3 * 3, 0.5F);
  }
  model.throughput.weights[7] = -1.25F;
  model.training_config = R"({"seed":1})";
  return model;
}

/// The small model's bytes after a change of the content, with a new checksum.
template <typename Change>
std::string changed(Change change) {
  proto::SealedModel sealed;
  REQUIRE(sealed.ParseFromString(small_model().to_bytes()));
  proto::Model model;
  REQUIRE(model.ParseFromString(sealed.model()));
  change(model);
  sealed.set_model(model.SerializeAsString());
  sealed.set_sha256(sha256_hex(sealed.model()));
  return sealed.SerializeAsString();
}

void check_refused(const std::string& bytes, const std::string& reason) {
  std::string message = "accepted";
  try {
    (void)parse_pretrained_model(bytes, "x.pb");
  } catch (const InputError& error) {
    message = error.what();
  }
  CHECK_THAT(message, Contains("x.pb") && Contains("train one with 'aloft train pretrained'") && Contains(reason));
}

}  // namespace

TEST_CASE("a model file gives back what was written") {
  const PretrainedModel model = small_model();
  const PretrainedModel read = parse_pretrained_model(model.to_bytes(), "x.pb");
  CHECK(read.spectral_efficiency.weights == model.spectral_efficiency.weights);
  CHECK(read.throughput.weights == model.throughput.weights);
  CHECK(read.throughput.hidden_width == 2);
  CHECK(read.training_config == model.training_config);
  CHECK(read.to_bytes() == model.to_bytes());
}

TEST_CASE("unusable model files are refused with the reason") {
  const std::string good = small_model().to_bytes();
  check_refused("", "truncated");
  check_refused("not a model", "not a model file");
  std::string altered = good;
  altered[good.size() / 2] ^= 4;
  check_refused(altered, "altered");
  proto::SealedModel sealed;
  REQUIRE(sealed.ParseFromString(good));
  sealed.set_format_version(2);
  check_refused(sealed.SerializeAsString(), "newer format 2");
  check_refused(changed([](proto::Model& model) { model.set_state_layout_version(9); }), "state layout 9");
  check_refused(changed([](proto::Model& model) { model.mutable_networks()->RemoveLast(); }),
                "no network for throughput");
  check_refused(changed([](proto::Model& model) { model.mutable_networks(0)->mutable_weights()->RemoveLast(); }),
                "182 weights where 183 are needed");
  check_refused(changed([](proto::Model& model) { model.mutable_networks(0)->set_weights(3, NAN); }), "finite");
}

TEST_CASE("a model file that is cut at any byte, or has any bit flipped, is refused with a hint") {
  const std::string good = small_model().to_bytes();
  for (std::size_t size = 0; size < good.size(); ++size) {
    INFO("cut to " << size << " bytes");
    check_refused(good.substr(0, size), "truncated");
  }
  for (std::size_t bit = 0; bit < good.size() * 8; ++bit) {
    INFO("bit " << bit);
    std::string altered = good;
    altered[bit / 8] = static_cast<char>(altered[bit / 8] ^ (1 << (bit % 8)));
    check_refused(altered, "");
  }
}

TEST_CASE("the preferred action is the largest value; ties hold, then go down") {
  const auto preferred = [](float down, float hold, float up) {
    return preferred_action(std::array<float, 3>{down, hold, up});
  };
  CHECK(preferred(1, 0, 0) == 0);
  CHECK(preferred(0, 1, 0) == 1);
  CHECK(preferred(0, 0, 1) == 2);
  CHECK(preferred(1, 1, 1) == 1);
  CHECK(preferred(1, 0, 1) == 0);
}
