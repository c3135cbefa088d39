#include "common/radio/testing/link_model_conformance.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <catch2/catch.hpp>
#include <cmath>
#include <cstddef>
#include <exception>
#include <memory>
#include <optional>

#include "common/radio/generated_world.hpp"
#include "common/radio/link_budget.hpp"
#include "common/world/city.hpp"

namespace aloft::radio {
namespace {

constexpr std::uint64_t seed = 7;

/// A model's answers for one link, with and without line of sight.
struct Answers {
  double blocking_height_m = 0.0;
  std::array<std::vector<double>, 2> gain;
  std::array<std::vector<double>, 2> deviation_db;
  std::array<double, 2> bound{};

  bool operator==(const Answers& other) const {
    const auto bits = [](double x) { return std::bit_cast<std::uint64_t>(x); };
    const auto same_bits = [&](double a, double b) { return bits(a) == bits(b); };
    bool same = same_bits(blocking_height_m, other.blocking_height_m);
    for (const std::size_t los : {0U, 1U}) {
      same = same && same_bits(bound.at(los), other.bound.at(los));
      same = same && std::ranges::equal(gain.at(los), other.gain.at(los), same_bits);
      same = same && std::ranges::equal(deviation_db.at(los), other.deviation_db.at(los), same_bits);
    }
    return same;
  }
};

/// Checks the links of one trial: along the route, beside it, and below and above a base station.
class Kit {
 public:
  Kit(const LinkModelType& type, const Parameters& world, std::uint32_t trial)
      : type_(type), world_(world), city_(world::generate_city(world, seed, trial)), trial_(trial) {
    for (int i = 0; i < 101; ++i)
      height_m_.push_back(city_.base_station_height_m + 2.7 * i);  // not a multiple of 8: rows end within a vector
    const auto stations = static_cast<std::uint32_t>(std::min<std::size_t>(city_.base_stations.size(), 6));
    places_.push_back(city_.base_stations[0]);
    for (const world::Position uav : places_)
      for (std::uint32_t k = 0; k < stations; ++k) links_.push_back(link(uav, k));
  }

  void run(std::vector<std::string>& problems) {
    const auto model = make();
    std::vector<Answers> first;
    for (const LinkPlace& link : links_) {
      first.push_back(ask(*model, link));
      check_values(*model, link, first.back(), problems);
      check_elements(*model, link, first.back(), problems);
    }
    check_stations(*model, problems);
    const auto other = make();
    for (std::size_t i = links_.size(); i-- > 0;) {
      if (ask(*model, links_[i]) != first[i])
        say(problems, links_[i],
            "the answers change when the model is asked again: it must be a pure function of place");
      if (ask(*other, links_[i]) != first[i])
        say(problems, links_[i], "another object of the same trial, asked in another order, answers differently");
    }
  }

 private:
  [[nodiscard]] std::unique_ptr<LinkModel> make() const { return type_.make(world_, city_, seed, trial_); }

  [[nodiscard]] LinkPlace link(world::Position uav, std::uint32_t k) const {
    const world::Position station = city_.base_stations[k];
    return {uav, k, std::hypot(station.x_m - uav.x_m, station.y_m - uav.y_m)};
  }

  [[nodiscard]] Answers ask(const LinkModel& model, const LinkPlace& link) const {
    Answers answers;
    answers.blocking_height_m = model.blocking_height_m(link);
    for (const std::size_t los : {0U, 1U}) {
      answers.gain.at(los).resize(height_m_.size());
      model.mean_gain_row(link, los == 1, height_m_, answers.gain.at(los).data());
      answers.deviation_db.at(los).resize(height_m_.size());
      model.shadowing_row(link, los == 1, height_m_, answers.deviation_db.at(los).data());
      answers.bound.at(los) = model.gain_bound(link, los == 1);
    }
    return answers;
  }

  void check_values(const LinkModel& model, const LinkPlace& link, const Answers& answers,
                    std::vector<std::string>& problems) const {
    if (std::isnan(answers.blocking_height_m)) say(problems, link, "blocking_height_m() is not a number");
    std::vector<double> compared_m = height_m_;
    if (std::isfinite(answers.blocking_height_m))
      for (const double away_m : {0.0, 1e-9, 1e-7, 1e-5, 1e-3})
        for (const double sign : {-1.0, 1.0}) compared_m.push_back(answers.blocking_height_m + sign * away_m);
    for (const double height_m : compared_m)
      if (height_m >= city_.base_station_height_m &&
          model.line_of_sight(link, height_m) != (height_m >= answers.blocking_height_m))
        say(problems, link, fmt::format("line_of_sight() at {} m is not what blocking_height_m() says", height_m));
    for (const std::size_t los : {0U, 1U}) {
      const Shadowing shadowing = model.shadowing(los == 1);
      if (shadowing.deviation_max_db > 0.0 && !(shadowing.correlation_distance_m > 0.0))
        say(problems, link, "shadowing() has no correlation distance");
      for (std::size_t i = 0; i < height_m_.size(); ++i) {
        const double gain = answers.gain.at(los)[i];
        if (!std::isfinite(gain) || gain <= 0.0)
          say(problems, link,
              fmt::format("the gain at {:g} m is {}; it must be positive and finite", height_m_[i], gain));
        else if (!(gain <= answers.bound.at(los) * bound_rounding))
          say(problems, link,
              fmt::format("the gain {} at {:g} m {} line of sight exceeds gain_bound() {}", gain, height_m_[i],
                          los == 1 ? "with" : "without", answers.bound.at(los)));
        const double deviation_db = answers.deviation_db.at(los)[i];
        if (!(deviation_db >= 0.0 && deviation_db <= shadowing.deviation_max_db))
          say(problems, link,
              fmt::format("the standard deviation of shadowing at {:g} m is {} dB; shadowing() says 0 to {}",
                          height_m_[i], deviation_db, shadowing.deviation_max_db));
      }
    }
  }

  /// Short rows, down to one element, must have the bits of the long row: the table is computed in rows, its
  /// explanation at single heights.
  void check_elements(const LinkModel& model, const LinkPlace& link, const Answers& answers,
                      std::vector<std::string>& problems) const {
    for (const std::size_t los : {0U, 1U})
      for (const std::size_t size : {std::size_t{1}, std::size_t{5}})
        for (std::size_t i = 0; i + size <= height_m_.size(); i += size) {
          std::vector<double> part(size);
          model.shadowing_row(link, los == 1, std::span(height_m_).subspan(i, size), part.data());
          if (!std::equal(part.begin(), part.end(),
                          answers.deviation_db.at(los).begin() + static_cast<std::ptrdiff_t>(i)))
            say(problems, link,
                fmt::format("shadowing_row() gives other bits at {:g} m in a row of {} than in a row of {}",
                            height_m_[i], size, height_m_.size()));
          model.mean_gain_row(link, los == 1, std::span(height_m_).subspan(i, size), part.data());
          if (!std::equal(part.begin(), part.end(), answers.gain.at(los).begin() + static_cast<std::ptrdiff_t>(i)))
            say(problems, link,
                fmt::format("mean_gain_row() gives other bits at {:g} m in a row of {} than in a row of {}",
                            height_m_[i], size, height_m_.size()));
        }
  }

  /// All base stations at one height must have the bits of their rows: flights read single heights, foresight the
  /// table.
  void check_stations(const LinkModel& model, std::vector<std::string>& problems) const {
    for (const world::Position uav : places_) {
      std::vector<LinkPlace> all;
      std::vector<double> distance_m;
      for (std::uint32_t k = 0; k < city_.base_stations.size(); ++k) {
        all.push_back(link(uav, k));
        distance_m.push_back(all.back().distance_m);
      }
      std::vector<double> gains(all.size());
      for (const double height_m : {height_m_.front(), height_m_[37], height_m_.back()})
        for (const bool line_of_sight : {false, true}) {
          model.mean_gains(uav, distance_m, line_of_sight, height_m, gains.data());
          for (const LinkPlace& one : all) {
            double expected = 0.0;
            model.mean_gain_row(one, line_of_sight, std::span(&height_m, 1), &expected);
            if (gains[one.station] != expected)
              say(problems, one, fmt::format("mean_gains() gives other bits at {:g} m than mean_gain_row()", height_m));
          }
        }
    }
  }

  /// One sentence per kind of problem and link is enough.
  void say(std::vector<std::string>& problems, const LinkPlace& link, const std::string& what) const {
    if (problems.size() < 20)
      problems.push_back(fmt::format("channel model {}, trial {}, UAV at ({:g}, {:g}), base station {}: {}", type_.name,
                                     trial_, link.uav.x_m, link.uav.y_m, link.station, what));
  }

  const LinkModelType& type_;
  const Parameters& world_;
  world::City city_;
  std::uint32_t trial_;
  std::vector<double> height_m_;
  std::vector<world::Position> places_{{-505.0, 0.0}, {0.0, 10.0}, {123.4, -5.6}, {495.0, 0.0}};
  std::vector<LinkPlace> links_;
};

}  // namespace

std::vector<std::string> link_model_problems(const LinkModelType& type, const nlohmann::json& world) {
  std::vector<std::string> problems;
  if (type.name.empty() || type.description.empty() || !type.description.ends_with('.'))
    problems.push_back(fmt::format("channel model '{}' needs a name, and a sentence that describes it", type.name));
  nlohmann::json given = type.defaults;
  given.update(world);
  const Parameters parameters(generated_world_parameters(type), given, "world");
  for (std::uint32_t trial = 0; trial < 3; ++trial) Kit(type, parameters, trial).run(problems);
  return problems;
}

void check_link_model(std::string_view name, const nlohmann::json& world) {
  const std::vector<std::string> problems = link_model_problems(link_model_type(name), world);
  for (const std::string& problem : problems) FAIL_CHECK(problem);
  CHECK(problems.empty());
}

double mean_gain(std::string_view name, const nlohmann::json& world, double distance_m, double height_m,
                 bool line_of_sight) {
  const LinkModelType& type = link_model_type(name);
  const world::City city{3000.0, 30.0, {{distance_m, 0.0}}, 0, 0, 30.0, {}};
  const auto model = type.make(Parameters(generated_world_parameters(type), world, "world"), city, seed, 0);
  double gain = 0.0;
  model->mean_gain_row({{0.0, 0.0}, 0, distance_m}, line_of_sight, std::span(&height_m, 1), &gain);
  return gain;
}

}  // namespace aloft::radio
