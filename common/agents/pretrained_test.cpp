#include <catch2/catch.hpp>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "common/agents/pretrained_builtin.hpp"
#include "common/agents/pretrained_model.hpp"
#include "common/agents/pretrained_state.hpp"
#include "common/base/digest.hpp"
#include "common/base/error.hpp"
#include "common/flight/flight.hpp"
#include "common/flight/testing/conformance.hpp"
#include "common/flight/testing/synthetic_map.hpp"
#include "tests/paths.hpp"

using namespace aloft::agents;
using aloft::flight::SyntheticMap;
using Catch::Contains;

namespace {

/// The network's values by the definition, in double precision.
std::array<double, 3> values_of(const PretrainedModel::Network& network, const PretrainedState& state) {
  std::array<float, PretrainedState::inputs> inputs{};
  state.encode(inputs);
  std::vector<double> below(inputs.begin(), inputs.end());
  std::size_t at = 0;
  const std::array<std::size_t, 3> widths = {network.hidden_width, network.hidden_width, 3};
  for (std::size_t layer = 0; layer < widths.size(); ++layer) {
    std::vector<double> sums;
    for (std::size_t o = 0; o < widths[layer]; ++o) {
      double sum = 0.0;
      for (const double x : below) sum += x * static_cast<double>(network.weights[at++]);
      sum += static_cast<double>(network.weights[at++]);
      sums.push_back(layer < 2 ? std::max(sum, 0.0) : sum);
    }
    below = sums;
  }
  return {below[0], below[1], below[2]};
}

}  // namespace

TEST_CASE("pretrained conforms") {
  aloft::flight::check_conformance("pretrained");
}

TEST_CASE("pretrained flies the action that its network prefers") {
  const PretrainedModel model = parse_pretrained_model(builtin_model(), "built-in");
  const AgentSpec spec = parse_agents("pretrained", "agents[0]").front();
  for (const QosKind kind : {QosKind::spectral_efficiency, QosKind::throughput}) {
    SyntheticMap map = SyntheticMap::random(kind, 60, 9, 5);
    aloft::flight::Flight flight(map, 1, 0);
    PretrainedState state(kind, 9);
    const auto agent = spec.make();
    agent->begin(flight.info());
    while (true) {
      const Observation& observation = flight.observation();
      const auto level = static_cast<std::uint32_t>(std::lround((observation.height_m - 40.0) / 10.0));
      state.observe(pretrained_report(kind, level, observation));
      agent->observe(observation);
      if (flight.finished()) break;
      const Command command = agent->act();
      const auto expected = values_of(model.network(kind), state);
      REQUIRE(command.introspection.has_value());
      const auto chosen = static_cast<std::size_t>(command.action) - static_cast<std::size_t>(Action::down);
      for (std::size_t a = 0; a < 3; ++a) {
        CHECK(command.introspection->q_values[a] == Approx(expected[a]).margin(1e-4));
        CHECK(expected[chosen] >= expected[a] - 1e-4);
      }
      flight.step(command, "pretrained");
    }
  }
}

TEST_CASE("pretrained takes a model file and refuses a damaged one by name") {
  const auto file = std::filesystem::temp_directory_path() / "aloft_pretrained_test.pb";
  const auto make = [&](std::string_view bytes) {
    std::ofstream(file, std::ios::binary) << bytes;
    return parse_agents({{"type", "pretrained"}, {"model", file.string()}}, "agents[0]").front().make();
  };
  CHECK_NOTHROW(make(builtin_model()));
  CHECK_THROWS_WITH(make(builtin_model().substr(0, 1'000)), Contains(file.string()) && Contains("truncated"));
  std::filesystem::remove(file);
  const AgentSpec missing = parse_agents({{"type", "pretrained"}, {"model", "/no/such.pb"}}, "agents[0]").front();
  CHECK_THROWS_AS(missing.make(), aloft::InputError);
}

TEST_CASE("the built-in model has the SHA-256 of the published file") {
  std::ifstream stream(aloft::test::source_dir() / "data/models/pretrained.pb.sha256");
  std::string expected;
  stream >> expected;
  CHECK(aloft::sha256_hex(builtin_model()) == expected);
  CHECK(builtin_model_sha256() == expected);
  CHECK(builtin_model().size() < 1'000'000);
  const PretrainedModel model = parse_pretrained_model(builtin_model(), "built-in");
  CHECK(nlohmann::json::parse(model.training_config).contains("spectral_efficiency"));
}
