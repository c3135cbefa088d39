#include "tools/importer/measurement_grid.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <set>

#include "common/base/error.hpp"

namespace aloft::importer {
namespace {

/// Names of the two vectors of an agent, which hold its flights one after another with one value per step.
struct Recording {
  std::string_view throughput;
  std::string_view level;
};

// The learner comes last: a cell keeps its first value, and only the learner's values have rounding noise.
constexpr std::array<Recording, 6> recordings{{{"constAchieveableRate", "constheight"},
                                               {"const1AchieveableRate", "const1height"},
                                               {"const2AchieveableRate", "const2height"},
                                               {"maxAchieveableRate", "maxheight"},
                                               {"randAchieveableRate", "randheight"},
                                               {"achieveableRate", "height"}}};

/// Largest throughput of each step, and one value more at the end of each flight.
constexpr std::string_view step_maximum = "optmAchieveableRate";

constexpr double max_level = 1000;
constexpr double rounding = 1e-12;  // relative

/// A grid while it is rebuilt, and the source of each value.
class Rebuild {
 public:
  Rebuild(const NumericVectors& vectors, const GridOptions& options, std::string_view where)
      : vectors_(vectors), options_(options), where_(where) {}

  MeasurementGrid run() {
    check_vectors();
    grid_.height_min_m = options_.height_min_m;
    grid_.height_step_m = options_.height_step_m;
    grid_.steps = options_.steps ? checked_steps(*options_.steps) : detected_steps();
    grid_.heights = highest_level();
    grid_.throughput_kbps.assign(std::size_t{grid_.steps} * grid_.heights, 0.0);
    grid_.observed.assign(grid_.throughput_kbps.size(), false);
    sources_.resize(grid_.throughput_kbps.size());
    for (const Recording& recording : recordings) place(recording);
    fill();
    return std::move(grid_);
  }

 private:
  struct Source {
    std::string_view vector;
    std::size_t index = 0;
  };

  [[noreturn]] void refuse(const std::string& reason) const { throw InputError("{}: {}", where_, reason); }

  const std::vector<double>& vector(std::string_view name) const { return vectors_.find(name)->second; }

  void check_vectors() const {
    std::vector<std::string_view> missing;
    const auto need = [&](std::string_view name) {
      if (!vectors_.contains(name) || vector(name).empty()) missing.push_back(name);
    };
    for (const Recording& recording : recordings) {
      need(recording.throughput);
      need(recording.level);
    }
    need(step_maximum);
    if (!missing.empty()) {
      std::vector<std::string_view> found;
      for (const auto& [name, values] : vectors_) found.push_back(name);
      refuse(fmt::format(
          "the workspace has no numeric values for {} (it has {}). Give one of the authors' workspaces "
          "of a measured flight, such as Real_canal_tudo1.Rdata.",
          fmt::join(missing, ", "), found.empty() ? "no numeric vectors" : fmt::format("{}", fmt::join(found, ", "))));
    }
    for (const Recording& recording : recordings) check_values(recording);
    const std::vector<double>& maxima = vector(step_maximum);
    for (std::size_t i = 0; i < maxima.size(); ++i) check_throughput(step_maximum, i, maxima[i]);
  }

  void check_values(const Recording& recording) const {
    const std::vector<double>& throughput = vector(recording.throughput);
    const std::vector<double>& level = vector(recording.level);
    if (throughput.size() != level.size())
      refuse(
          fmt::format("{} has {} values but {} has {}; each throughput needs its height. The workspace is not one "
                      "of the authors' measured flights.",
                      recording.throughput, throughput.size(), recording.level, level.size()));
    for (std::size_t i = 0; i < level.size(); ++i) {
      check_throughput(recording.throughput, i, throughput[i]);
      if (!(level[i] >= 1 && level[i] <= max_level && level[i] == std::floor(level[i])))
        refuse(fmt::format("{}[{}] is {}; allowed are level numbers, whole, from 1 to {}.", recording.level, i + 1,
                           level[i], max_level));
    }
  }

  void check_throughput(std::string_view name, std::size_t index, double value) const {
    if (!(value >= 0 && std::isfinite(value)))
      refuse(fmt::format("{}[{}] is {}; allowed are throughputs in kbit/s, 0 or more.", name, index + 1, value));
  }

  bool fits(std::size_t steps) const {
    return steps > 0 && vector(step_maximum).size() % (steps + 1) == 0 &&
           std::ranges::all_of(recordings, [&](const Recording& recording) {
             return vector(recording.throughput).size() % steps == 0;
           });
  }

  std::string lengths() const {
    std::string text;
    for (const Recording& recording : recordings)
      text += fmt::format("{} {}, ", recording.throughput, vector(recording.throughput).size());
    return text + fmt::format("{} {}", step_maximum, vector(step_maximum).size());
  }

  std::uint32_t checked_steps(std::uint32_t steps) const {
    if (!fits(steps))
      refuse(
          fmt::format("the vectors do not hold whole flights of {} steps (lengths: {}; the last has one value more "
                      "per flight). Correct --steps, or leave it out to have it detected.",
                      steps, lengths()));
    return steps;
  }

  /// Step maxima have one value more per flight: n * (steps + 1) for n flights. An agent with n flights has n * steps
  /// values, so that the difference of the lengths is n.
  std::uint32_t detected_steps() const {
    const std::size_t maxima = vector(step_maximum).size();
    std::set<std::size_t> candidates;
    for (const Recording& recording : recordings) {
      const std::size_t length = vector(recording.throughput).size();
      if (length >= maxima || length % (maxima - length) != 0) continue;
      if (fits(length / (maxima - length))) candidates.insert(length / (maxima - length));
    }
    if (candidates.size() != 1)
      refuse(
          fmt::format("the number of steps of a flight does not follow from the vectors' lengths ({}). Give it: "
                      "--steps N (Grand Canal Quay 170, North Wall Quay 160).",
                      lengths()));
    return static_cast<std::uint32_t>(*candidates.begin());
  }

  std::uint32_t highest_level() const {
    double highest = 0;
    for (const Recording& recording : recordings)
      highest = std::max(highest, *std::ranges::max_element(vector(recording.level)));
    return static_cast<std::uint32_t>(highest);
  }

  double height_m(std::size_t level) const {
    return grid_.height_min_m + grid_.height_step_m * static_cast<double>(level);
  }

  void place(const Recording& recording) {
    const std::vector<double>& throughput = vector(recording.throughput);
    const std::vector<double>& level = vector(recording.level);
    for (std::size_t i = 0; i < throughput.size(); ++i) {
      const std::size_t cell = i % grid_.steps * grid_.heights + static_cast<std::size_t>(level[i]) - 1;
      if (!grid_.observed[cell]) {
        grid_.throughput_kbps[cell] = throughput[i];
        grid_.observed[cell] = true;
        sources_[cell] = {recording.throughput, i};
      } else if (std::abs(throughput[i] - grid_.throughput_kbps[cell]) > rounding * throughput[i]) {
        conflict(cell, {recording.throughput, i});
      }
    }
    grid_.triples += throughput.size();
  }

  [[noreturn]] void conflict(std::size_t cell, const Source& second) const {
    const Source& first = sources_[cell];
    refuse(
        fmt::format("two different throughputs for step {}, height {} m: {}[{}] is {} and {}[{}] is {} kbit/s. "
                    "Flights of {} steps were assumed; if theirs are not that long, give --steps.",
                    cell / grid_.heights + 1, height_m(cell % grid_.heights), first.vector, first.index + 1,
                    vector(first.vector)[first.index], second.vector, second.index + 1,
                    vector(second.vector)[second.index], grid_.steps));
  }

  void fill() {
    const std::vector<double>& maxima = vector(step_maximum);
    for (std::size_t step = 0; step < grid_.steps; ++step) {
      for (std::size_t level = 0; level < grid_.heights; ++level) {
        double& value = grid_.throughput_kbps[step * grid_.heights + level];
        if (!grid_.observed[step * grid_.heights + level])
          value = std::min(nearest_recorded(step, level), maxima[step]);
        else if (value > maxima[step] * (1 + rounding))
          ++grid_.above_known_maximum;
      }
    }
  }

  double nearest_recorded(std::size_t step, std::size_t level) const {
    for (std::size_t distance = 1; distance < grid_.steps; ++distance) {
      const std::size_t before = (step - distance) * grid_.heights + level;
      const std::size_t after = (step + distance) * grid_.heights + level;
      if (step >= distance && grid_.observed[before]) return grid_.throughput_kbps[before];
      if (step + distance < grid_.steps && grid_.observed[after]) return grid_.throughput_kbps[after];
    }
    refuse(
        fmt::format("no flight was ever at level {} ({} m), so that height cannot be filled in. The workspace is "
                    "not one of the authors' measured flights.",
                    level + 1, height_m(level)));
  }

  const NumericVectors& vectors_;
  const GridOptions& options_;
  std::string_view where_;
  MeasurementGrid grid_;
  std::vector<Source> sources_;  // where each cell's value comes from
};

}  // namespace

MeasurementGrid rebuild_grid(const NumericVectors& vectors, const GridOptions& options, std::string_view where) {
  if (!(options.height_step_m > 0 && options.height_step_m <= 1000))
    throw InputError("--height-step is {}; allowed: above 0, up to 1000 m.", options.height_step_m);
  if (!(options.height_min_m >= 0 && options.height_min_m <= 10000))
    throw InputError("--height-min is {}; allowed: 0 to 10000 m.", options.height_min_m);
  return Rebuild(vectors, options, where).run();
}

std::string to_csv(const MeasurementGrid& grid) {
  std::string csv = "step,height_m,throughput_kbps,observed\n";
  for (std::size_t cell = 0; cell < grid.throughput_kbps.size(); ++cell) {
    const double height_m = grid.height_min_m + grid.height_step_m * static_cast<double>(cell % grid.heights);
    csv += fmt::format("{},{},{:.15g},{}\n", cell / grid.heights + 1, height_m, grid.throughput_kbps[cell],
                       grid.observed[cell] ? 1 : 0);
  }
  return csv;
}

}  // namespace aloft::importer
