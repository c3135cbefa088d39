#include "common/radio/generated_map.hpp"

#include <map>

#include "common/radio/column.hpp"
#include "common/world/route.hpp"

namespace aloft::radio {
namespace {

class GeneratedMap final : public SignalMap {
 public:
  GeneratedMap(const Parameters& world, const world::City& city, std::uint64_t seed, std::uint32_t trial)
      : scene_(world, city, seed, trial),
        route_(world, city),
        builder_(scene_, Fading(scene_.model(), seed, trial)),
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
    if (at == columns.end()) at = columns.emplace(position.y_m, builder_.build(point, position)).first;
    return at->second;
  }

 private:
  Scene scene_;
  world::Route route_;
  ColumnBuilder builder_;
  std::vector<std::map<double, std::vector<Reading>>> columns_;  // per route point, by y: x follows from the point
};

}  // namespace

std::unique_ptr<SignalMap> make_generated_map(const Parameters& world, const world::City& city, std::uint64_t seed,
                                              std::uint32_t trial) {
  return std::make_unique<GeneratedMap>(world, city, seed, trial);
}

}  // namespace aloft::radio
