// Each channel model here breaks one promise, and the kit must find it.
#include "common/radio/testing/link_model_conformance.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <limits>
#include <memory>

using namespace aloft::radio;  // NOLINT(google-build-using-namespace): a test of this namespace
using aloft::Parameters;
using Catch::Contains;

namespace {

/// The inverse square of the distance, with line of sight above 100 m. It keeps every promise.
class SoundModel : public LinkModel {
 public:
  [[nodiscard]] double blocking_height_m(const LinkPlace& /*link*/) const override { return 100.0; }
  void mean_gain_row(const LinkPlace& link, bool line_of_sight, std::span<const double> height_m,
                     double* gain) const override {
    for (std::size_t i = 0; i < height_m.size(); ++i)
      gain[i] = (line_of_sight ? 1.0 : 0.01) / (1.0 + link.distance_m * link.distance_m + height_m[i] * height_m[i]);
  }
  [[nodiscard]] double gain_bound(const LinkPlace& link, bool line_of_sight) const override {
    return (line_of_sight ? 1.0 : 0.01) / (1.0 + link.distance_m * link.distance_m);
  }
};

struct SumsUp : SoundModel {
  void mean_gain_row(const LinkPlace& link, bool line_of_sight, std::span<const double> height_m,
                     double* gain) const override {
    SoundModel::mean_gain_row(link, line_of_sight, height_m, gain);
    for (std::size_t i = 1; i < height_m.size(); ++i) gain[i] = std::nextafter(gain[i], gain[i - 1]);
  }
};
struct DiffersByStation : SoundModel {
  void mean_gains(aloft::world::Position uav, std::span<const double> distance_m, bool line_of_sight, double height_m,
                  double* gain) const override {
    SoundModel::mean_gains(uav, distance_m, line_of_sight, height_m, gain);
    gain[distance_m.size() - 1] = std::nextafter(gain[distance_m.size() - 1], 0.0);
  }
};
struct ExceedsItsBound : SoundModel {
  [[nodiscard]] double gain_bound(const LinkPlace& link, bool /*line_of_sight*/) const override {
    return SoundModel::gain_bound(link, false);
  }
};
struct IsNothing : SoundModel {
  void mean_gain_row(const LinkPlace& /*link*/, bool /*line_of_sight*/, std::span<const double> height_m,
                     double* gain) const override {
    std::fill_n(gain, height_m.size(), 0.0);
  }
};
struct BlocksNowhere : SoundModel {
  [[nodiscard]] double blocking_height_m(const LinkPlace& /*link*/) const override {
    return std::numeric_limits<double>::quiet_NaN();
  }
};
struct SeesElsewhere : SoundModel {
  [[nodiscard]] bool line_of_sight(const LinkPlace& /*link*/, double height_m) const override {
    return height_m > 100.0;
  }
};
struct CountsQuestions : SoundModel {
  [[nodiscard]] double blocking_height_m(const LinkPlace& /*link*/) const override { return ++questions_; }
  mutable double questions_ = 0.0;
};
struct DependsOnTheFirst : SoundModel {
  [[nodiscard]] double blocking_height_m(const LinkPlace& link) const override {
    if (first_m_ < 0.0) first_m_ = link.distance_m;
    return first_m_;
  }
  mutable double first_m_ = -1.0;
};
struct Shadows : SoundModel {
  [[nodiscard]] Shadowing shadowing(bool /*line_of_sight*/) const override { return {6.0, 50.0}; }
  void shadowing_row(const LinkPlace& /*link*/, bool /*line_of_sight*/, std::span<const double> height_m,
                     double* deviation_db) const override {
    std::fill_n(deviation_db, height_m.size(), 6.0);
  }
};
struct ShadowsMore : Shadows {
  [[nodiscard]] Shadowing shadowing(bool /*line_of_sight*/) const override { return {5.9, 50.0}; }
};
struct ShadowsAnywhere : Shadows {
  [[nodiscard]] Shadowing shadowing(bool /*line_of_sight*/) const override { return {6.0, 0.0}; }
};
struct ShadowsByRow : Shadows {
  void shadowing_row(const LinkPlace& /*link*/, bool /*line_of_sight*/, std::span<const double> height_m,
                     double* deviation_db) const override {
    std::fill_n(deviation_db, height_m.size(), 6.0 / static_cast<double>(height_m.size()));
  }
};

template <typename Model>
std::vector<std::string> problems_of(std::string description = "A model for tests.") {
  return link_model_problems(
      {.name = "under-test",
       .description = std::move(description),
       .make = [](const Parameters& /*world*/, const aloft::world::City& /*city*/, std::uint64_t /*seed*/,
                  std::uint32_t /*trial*/) { return std::make_unique<Model>(); }});
}

template <typename Model>
void check_named(const char* what) {
  const auto problems = problems_of<Model>();
  CHECK_FALSE(problems.empty());
  for (const std::string& problem : problems) CHECK_THAT(problem, Contains("under-test") && Contains(what));
}

}  // namespace

TEST_CASE("a channel model that keeps every promise has no problems") {
  CHECK(problems_of<SoundModel>().empty());
  CHECK(problems_of<Shadows>().empty());
}

TEST_CASE("a channel model that breaks a promise is named, and the promise") {
  check_named<SumsUp>("other bits");
  check_named<DiffersByStation>("mean_gains() gives other bits");
  check_named<ExceedsItsBound>("with line of sight exceeds gain_bound()");
  check_named<IsNothing>("must be positive and finite");
  check_named<BlocksNowhere>("not a number");
  check_named<SeesElsewhere>("not what blocking_height_m() says");
  check_named<CountsQuestions>("");
  check_named<DependsOnTheFirst>("another object of the same trial");
  check_named<ShadowsMore>("shadowing() says 0 to 5.9");
  check_named<ShadowsAnywhere>("no correlation distance");
  check_named<ShadowsByRow>("shadowing_row() gives other bits");
  CHECK_THAT(problems_of<SoundModel>("").front(), Contains("a sentence that describes it"));
}
