// A world with another channel model than the default: its parameters, its canonical form, its table.
#include "common/radio/models/link_model.hpp"

#include <algorithm>
#include <catch2/catch.hpp>
#include <limits>
#include <nlohmann/json.hpp>
#include <set>

#include "common/base/error.hpp"
#include "common/radio/generated_map.hpp"
#include "common/radio/generated_world.hpp"
#include "common/radio/inspect.hpp"
#include "common/world/city.hpp"

using namespace aloft;
using Catch::Contains;
using nlohmann::json;

namespace {

/// The inverse square of the distance, without line of sight at any height.
class InverseSquare final : public radio::LinkModel {
 public:
  explicit InverseSquare(double loss) : loss_(loss) {}
  [[nodiscard]] double blocking_height_m(const radio::LinkPlace& /*link*/) const override {
    return std::numeric_limits<double>::infinity();
  }
  void mean_gain_row(const radio::LinkPlace& link, bool line_of_sight, std::span<const double> height_m,
                     double* gain) const override {
    for (std::size_t i = 0; i < height_m.size(); ++i)
      gain[i] = line_of_sight ? 1e9 : 1.0 / (loss_ * (link.distance_m * link.distance_m + height_m[i] * height_m[i]));
  }
  [[nodiscard]] double gain_bound(const radio::LinkPlace& link, bool line_of_sight) const override {
    return line_of_sight ? 1e9 : 1.0 / (loss_ * (1.0 + link.distance_m * link.distance_m));
  }

 private:
  double loss_;
};

const bool inverse_square_registered = radio::register_link_model(
    {.name = "inverse-square",
     .description = "For tests.",
     .parameters = {number_parameter("inverse_square_loss", 2.0, 1.0, 1e6, "Of every link.")},
     .make = [](const Parameters& world, const world::City& /*city*/, std::uint64_t /*seed*/,
                std::uint32_t /*trial*/) -> std::unique_ptr<radio::LinkModel> {
       return std::make_unique<InverseSquare>(world.number("inverse_square_loss"));
     }});

}  // namespace

TEST_CASE("channel models are listed by name, and the parameters of worlds have different names") {
  const auto models = radio::link_model_types();
  REQUIRE(models.size() >= 2);
  CHECK(std::is_sorted(models.begin(), models.end(), [](const auto& a, const auto& b) { return a.name < b.name; }));
  CHECK_THROWS_AS(radio::link_model_type("no-such-model"), std::logic_error);
  std::set<std::string> names;
  for (const ParameterSpec& spec : radio::generated_world_parameters()) CHECK(names.insert(spec.name).second);
}

TEST_CASE("a world has the parameters of its channel model alone, and names it unless it is the default") {
  const json power_law = radio::resolve_generated_world(json::object(), "world").to_json();
  CHECK(power_law.contains("path_exponent_los"));
  CHECK_FALSE(power_law.contains("propagation"));
  CHECK_FALSE(power_law.contains("inverse_square_loss"));
  CHECK(radio::resolve_generated_world({{"propagation", "power-law"}}, "world").to_json() == power_law);

  const Parameters other = radio::resolve_generated_world(
      {{"propagation", "inverse-square"}, {"inverse_square_loss", 3}, {"preset", "paper-text"}}, "world");
  CHECK(other.to_json().at("propagation") == "inverse-square");
  CHECK(other.to_json().at("inverse_square_loss") == 3);
  CHECK_FALSE(other.to_json().contains("path_exponent_los"));
  CHECK(other.text("bs_antenna") == "sector");  // the preset's, where it is not the power law's
  CHECK(radio::resolve_generated_world(other.to_json(), "world").to_json() == other.to_json());

  const auto resolve = [](const json& given) { return radio::resolve_generated_world(given, "world"); };
  CHECK_THROWS_WITH(resolve({{"propagation", "inverse-square"}, {"los_ray", "geometric"}}),
                    Contains("world.los_ray: unknown key"));
  CHECK_THROWS_WITH(resolve({{"inverse_square_loss", 3}}), Contains("world.inverse_square_loss: unknown key"));
  CHECK_THROWS_WITH(resolve({{"propagation", "ray-tracing"}}), Contains("world.propagation") && Contains("power-law"));
}

TEST_CASE("a world's table has the gains of its channel model, and is explained to the bit") {
  const json given{{"propagation", "inverse-square"}, {"bs_density_per_km2", 5}};
  const Parameters world = radio::resolve_generated_world(given, "world");
  const world::City city = world::generate_city(world, 9, 1);
  const auto map = radio::make_generated_map(world, city, 9, 1);
  const auto without_columns = radio::make_generated_map(world, city, 9, 1);
  for (std::uint32_t point = 0; point <= 100; point += 20) {
    const auto& column = map->column(point, map->advance(point, {}, -1));
    for (std::uint32_t i = 0; i < column.size(); i += 40) {
      const radio::Explanation explanation = radio::explain(world, city, 9, 1, point, map->heights().height_m(i));
      CHECK(explanation.spectral_efficiency == column[i].qos);
      CHECK(explanation.serving_sinr_db == column[i].serving_sinr_db);
      const radio::Reading alone = without_columns->reading(point, explanation.position, i);
      CHECK(alone.qos == column[i].qos);
      CHECK(alone.neighbour_sinr_db == column[i].neighbour_sinr_db);
      for (const radio::StationExplanation& station : explanation.stations) CHECK_FALSE(station.line_of_sight);
    }
  }
}
