#include "common/radio/generated_map.hpp"

#include <map>
#include <optional>

#include "common/radio/column.hpp"
#include "common/radio/spot.hpp"
#include "common/world/route.hpp"
#include "common/world/site_map.hpp"

namespace aloft::radio {
namespace {

class GeneratedMap final : public SignalMap {
 public:
  GeneratedMap(const Parameters& world, const world::City& city, std::uint64_t seed, std::uint32_t trial)
      : world_(world),
        seed_(seed),
        trial_(trial),
        scene_(world, city, seed, trial),
        route_(world, city),
        column_builder_(scene_, Fading(scene_.model(), seed, trial)),
        spot_builder_(scene_, Fading(scene_.model(), seed, trial)),
        columns_(route_.steps() + 1) {}

  [[nodiscard]] QosKind qos_kind() const noexcept override { return QosKind::spectral_efficiency; }
  [[nodiscard]] const HeightGrid& heights() const noexcept override { return scene_.heights(); }
  [[nodiscard]] std::uint32_t steps() const noexcept override { return route_.steps(); }
  [[nodiscard]] std::uint32_t result_point(std::uint32_t step) const noexcept override { return step; }
  [[nodiscard]] world::Position start() const noexcept override { return route_.start(); }
  [[nodiscard]] world::Position advance(std::uint32_t point, world::Position from,
                                        std::int32_t serving_cell) const noexcept override {
    return route_.advance(point, from, serving_cell);
  }
  [[nodiscard]] bool fixed_route() const noexcept override { return route_.fixed(); }

  [[nodiscard]] const std::vector<Reading>& column(std::uint32_t point, world::Position position) override {
    auto& columns = columns_.at(point);
    auto at = columns.find(position.y_m);
    if (at == columns.end()) at = columns.emplace(position.y_m, column_builder_.build(point, position)).first;
    return at->second;
  }

  [[nodiscard]] Reading reading(std::uint32_t point, world::Position position, std::uint32_t height) override {
    const auto& columns = columns_.at(point);
    const auto at = columns.find(position.y_m);
    return at == columns.end() ? spot_builder_.build(point, position, height) : at->second.at(height);
  }

  void scan(std::uint32_t point, world::Position position, std::uint32_t height, std::span<const std::int32_t> also,
            CellScan& into) override {
    spot_builder_.scan(point, position, height, also, into);
  }

  [[nodiscard]] const Survey* survey() override {
    if (!survey_) {
      std::vector<double> azimuth_deg;
      for (const double half_turns : scene_.sector_azimuths()) azimuth_deg.push_back(180.0 * half_turns);
      survey_ = {world_, world::draw_site_map(world_, scene_.city().base_stations, azimuth_deg, seed_, trial_)};
    }
    return &*survey_;
  }

 private:
  Parameters world_;
  std::uint64_t seed_;
  std::uint32_t trial_;
  std::optional<Survey> survey_;
  Scene scene_;
  world::Route route_;
  ColumnBuilder column_builder_;
  SpotBuilder spot_builder_;
  std::vector<std::map<double, std::vector<Reading>>> columns_;  // per route point, by y: x follows from the point
};

}  // namespace

std::unique_ptr<SignalMap> make_generated_map(const Parameters& world, const world::City& city, std::uint64_t seed,
                                              std::uint32_t trial) {
  return std::make_unique<GeneratedMap>(world, city, seed, trial);
}

}  // namespace aloft::radio
