#include "bench/widths_table.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <vector>

#include "bench/cache_levels.hpp"
#include "bench/step_traffic.hpp"
#include "bench/training_speed.hpp"
#include "common/base/number_text.hpp"
#include "common/learn/network.hpp"

namespace bench {
namespace {

using namespace aloft;
using learn::Loss;
using learn::Path;

constexpr std::size_t narrowest = 16;
constexpr std::size_t widest = 1024;
constexpr std::size_t paper_width = 200;
constexpr double row_s = 1.5;  ///< how long a row may take, about

struct Widths {
  std::size_t first = 0;
  std::size_t last = 0;
};

std::optional<Widths> parse(const std::string& text) {
  const std::size_t dots = text.find("..");
  if (dots == std::string::npos) return std::nullopt;
  const auto first = number_in<std::size_t>(text.substr(0, dots));
  const auto last = number_in<std::size_t>(text.substr(dots + 2));
  if (!first || !last || *first < narrowest || *last > widest || *first > *last) return std::nullopt;
  return Widths{*first, *last};
}

/// Eight to the octave, multiples of 16, so that no block has a remainder; and the paper's.
std::vector<std::size_t> widths_of(Widths range) {
  std::vector<std::size_t> widths;
  for (std::size_t width = range.first; width <= range.last; width += std::max<std::size_t>(16, width / 8 / 16 * 16))
    widths.push_back(width);
  if (range.first <= paper_width && paper_width <= range.last) widths.push_back(paper_width);
  std::sort(widths.begin(), widths.end());
  widths.erase(std::unique(widths.begin(), widths.end()), widths.end());
  return widths;
}

void print_levels(const std::vector<CacheLevel>& levels) {
  for (const CacheLevel& level : levels)
    fmt::print("{:<7} {:>9} {:>7.1f} GB/s\n", level.name,
               level.bytes == 0 ? "" : fmt::format("{} KiB", level.bytes / 1024), level.bytes_per_second * 1e-9);
}

void print_row(Path path, std::size_t width, const std::vector<CacheLevel>& levels) {
  const learn::NetworkShape shape = learn::dqn_shape(38, width);
  const StepTraffic traffic = step_traffic(shape, path, levels);
  fmt::print("{:<7} {:>5} {:>7.2f}", learn::path_name(path), width, static_cast<double>(traffic.array_bytes) * 1e-6);
  double transfer_s = 0.0;
  for (std::size_t i = 1; i < levels.size(); ++i) {
    fmt::print(" {:>9.0f}", static_cast<double>(traffic.bytes_from[i]) * 1e-3);
    transfer_s += static_cast<double>(traffic.bytes_from[i]) / levels[i].bytes_per_second;
  }
  fmt::print(" {:>9.1f}", transfer_s * 1e6);
  const double guess_s = 3e-11 * static_cast<double>(traffic.array_bytes) * static_cast<double>(epochs) * 2.0;
  const int trainings = std::clamp(static_cast<int>(row_s / guess_s / 2), 3, 60);
  for (const Loss loss : {Loss::mse, Loss::cross_entropy}) {
    const TrainingTime time = time_of_training(shape, path, loss, trainings);
    fmt::print(" {:>9.1f} {:>7.2f}", time.step_s * 1e6, time.step_s / time.floor.step_s(shape));
  }
  fmt::print("\n");
  std::fflush(stdout);
}

}  // namespace

std::string fault_of_widths(const std::string& text) {
  return parse(text) ? ""
                     : fmt::format("'{}': use FIRST..LAST with {} <= FIRST <= LAST <= {}", text, narrowest, widest);
}

void print_widths(const std::string& text) {
  const std::vector<CacheLevel> levels = measure_cache_levels();
  print_levels(levels);
  fmt::print("\n{:<7} {:>5} {:>7}", "path", "width", "MB");
  for (std::size_t i = 1; i < levels.size(); ++i) fmt::print(" {:>9}", "KB " + levels[i].name);
  fmt::print(" {:>9} {:>9} {:>7} {:>9} {:>7}\n", "transfer", "us mse", "x floor", "us c-e", "x floor");
  for (const Path path : learn::available_paths()) {
    if (path == Path::portable) continue;
    for (const std::size_t width : widths_of(*parse(text))) print_row(path, width, levels);
  }
}

}  // namespace bench
