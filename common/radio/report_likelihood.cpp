#include "common/radio/report_likelihood.hpp"

#include <algorithm>
#include <bit>
#include <limits>
#include <numbers>

#include "common/base/widest_vectors.hpp"
#include "common/radio/approximations.hpp"
#include "common/radio/sites.hpp"

namespace aloft::radio {
namespace {

using Compared = ReportLikelihood::Compared;
using Evaluation = ReportLikelihood::Evaluation;
using Report = ReportLikelihood::Report;

/// Share of the uniform density over 0 to 25 bit/s/Hz.
constexpr double unexplained = 0.005;
constexpr double most_bit_s_hz = 25.0;
/// Factor of the likelihood if the serving cell is none of the candidates.
constexpr double surprise = 0.01;
/// Powers below count as this: the array has nulls, in which ratios of powers would not be finite.
constexpr double least_power_w = 1e-30;

constexpr std::size_t lanes = 8;  // reported SINRs, and unused ones
static_assert(lanes >= ReportLikelihood::most_sinrs);
constexpr std::size_t most_interferers = 64;  // more are left out

/// How many neighbours are in each set.
constexpr auto members = [] {
  std::array<std::uint32_t, 1U << (ReportLikelihood::most_sinrs - 1)> counts{};
  for (std::uint32_t set = 1; set < counts.size(); ++set) counts[set] = counts[set & (set - 1)] + 1;
  return counts;
}();

template <class T>
auto compared_in(T& evaluation) noexcept {
  return std::span(evaluation.compared).first(evaluation.compared_count);
}

/// P(SINR > x) and the density of log2(1 + SINR) at each x, for powers of noise and interferers relative to the cell's.
[[gnu::always_inline]] inline void distribution_loop(double noise, const double* interference, std::size_t interferers,
                                                     const double* sinr, double* exceeds, double* density) {
  constexpr double most_halvings = 1000.0;  // what is left is 0
  std::array<double, lanes> rate;
  for (std::size_t j = 0; j < lanes; ++j) {
    const double halvings = noise * sinr[j] * (1.0 / std::numbers::ln2);
    exceeds[j] = exp2(halvings < most_halvings ? -halvings : -most_halvings);
    rate[j] = noise;
  }
  for (std::size_t i = 0; i < interferers; ++i) {
    for (std::size_t j = 0; j < lanes; ++j) {
      const double factor = 1.0 / (1.0 + sinr[j] * interference[i]);
      exceeds[j] *= factor;
      rate[j] += interference[i] * factor;
    }
  }
  for (std::size_t j = 0; j < lanes; ++j) density[j] = exceeds[j] * rate[j] * (1.0 + sinr[j]) * std::numbers::ln2;
}

/// The sum over all ways to assign cells to the reported neighbours, times the density of the serving cell's SINR.
/// Cells that are not assigned must be below the least. sums[set]: over the cells so far, with these neighbours
/// assigned.
double density_of(const Report& report, const Evaluation& evaluation) {
  const std::uint32_t neighbours = std::min(report.sinrs, evaluation.compared_count) - 1;
  std::array<double, 1U << (ReportLikelihood::most_sinrs - 1)> sums;
  std::fill_n(sums.begin(), 1U << neighbours, 0.0);
  sums[0] = evaluation.compared[0].density[0];
  std::uint32_t left = evaluation.compared_count - 1;  // cells; sets that lack more than these are of no use
  for (const Compared& cell : compared_in(evaluation).subspan(1)) {
    --left;
    for (std::uint32_t set = 1U << neighbours; set-- > 0;) {
      if (members[set] + left < neighbours) continue;
      double sum = sums[set] * cell.below_least;
      for (std::uint32_t rest = set; rest != 0; rest &= rest - 1)
        sum += sums[set & ~(rest & (~rest + 1))] * cell.density[static_cast<std::size_t>(std::countr_zero(rest)) + 1];
      sums[set] = sum;
    }
  }
  return sums[(1U << neighbours) - 1];
}

}  // namespace

ReportLikelihood::ReportLikelihood(const Parameters& world, const std::vector<world::Site>& sites)
    : scene_(world, city_of(world, sites), 0, 0, height_grid(world), sector_half_turns(world, sites)),
      compared_(std::min(scene_.reported_stations(), most_compared)) {}

void ReportLikelihood::look(const Report& report, std::span<const world::Position> stations, View& into) const {
  into.around.position = report.place;
  into.around.links.resize(stations.size());
  into.around.sector_covers.assign(stations.size(), 1);
  into.around.horizontal_loss_db.assign(stations.size(), 0.0);
  into.power_w.resize(stations.size());
  into.evaluation = {};
  for (std::uint32_t k = 0; k < stations.size(); ++k) place(report, k, stations[k], into);
  evaluate(report, into);
}

void ReportLikelihood::move(const Report& report, std::uint32_t station, world::Position to, View& view,
                            Undo& undo) const {
  undo.link = view.around.links[station];
  undo.sector_covers = view.around.sector_covers[station];
  undo.horizontal_loss_db = view.around.horizontal_loss_db[station];
  undo.power_w = view.power_w[station];
  undo.evaluated = false;
  mark_stale(station, view, undo);
  place(report, station, to, view);
  mark_stale(station, view, undo);
  if (undo.evaluated) evaluate(report, view);
}

void ReportLikelihood::take_back(const Undo& undo, std::uint32_t station, View& view) {
  view.around.links[station] = undo.link;
  view.around.sector_covers[station] = undo.sector_covers;
  view.around.horizontal_loss_db[station] = undo.horizontal_loss_db;
  view.power_w[station] = undo.power_w;
  if (undo.evaluated) view.evaluation = undo.evaluation;
}

inline bool ReportLikelihood::interferes(const View& view, const Compared& with, std::uint32_t station) const {
  const bool everywhere = scene_.model().uav_antenna == UavAntenna::omnidirectional;
  return scene_.can_interfere(view.around, with.station, station) &&
         (everywhere || with.beam.contain(view.around.links[station].distance_m));
}

bool ReportLikelihood::matters(const View& view, std::uint32_t station) const {
  return std::ranges::any_of(compared_in(view.evaluation), [&](const Compared& cell) {
    return cell.station == station || interferes(view, cell, station);
  });
}

void ReportLikelihood::place(const Report& report, std::uint32_t station, world::Position at, View& view) const {
  scene_.look_towards(at, station, view.around);
  const double rise_m = report.height_m - scene_.city().base_station_height_m;
  double& power_w = view.power_w[station];
  scene_.received_power_row(view.around, station, {&report.height_m, 1}, {&rise_m, 1}, 0, &power_w);
  power_w = std::max(power_w, least_power_w);
}

/// Whether the station's power, where it is now, decides which cells are compared, or whether the serving one is a
/// candidate.
bool ReportLikelihood::could_be_compared(const View& view, std::uint32_t station) const {
  const std::span cells = compared_in(view.evaluation);
  return view.power_w[station] >= std::min(view.power_w[cells.front().station], view.power_w[cells.back().station]);
}

/// Marks what depends on this station where it is now.
void ReportLikelihood::mark_stale(std::uint32_t station, View& view, Undo& undo) const {
  const bool ranked = !could_be_compared(view, station);
  if (ranked && !matters(view, station)) return;
  if (!undo.evaluated) undo.evaluation = view.evaluation;
  undo.evaluated = true;
  view.evaluation.ranked = view.evaluation.ranked && ranked;
  for (Compared& cell : compared_in(view.evaluation))
    if (cell.station == station || interferes(view, cell, station)) cell.stale = true;
}

void ReportLikelihood::evaluate(const Report& report, View& view) const {
  Evaluation& evaluation = view.evaluation;
  if (!evaluation.ranked) rank(report.serving, view);
  for (Compared& cell : compared_in(evaluation))
    if (cell.stale) compute(report, view, cell);
  const double factor = evaluation.stronger < scene_.serving_candidates() ? 1.0 : surprise;
  evaluation.likelihood = factor * density_of(report, evaluation);
}

/// Lists the serving cell and the strongest of the others, and keeps what is known of them.
void ReportLikelihood::rank(std::uint32_t serving, View& view) const {
  Evaluation& evaluation = view.evaluation;
  std::array<std::uint32_t, most_compared> stations{serving};
  std::uint32_t count = 0;  // of the others
  evaluation.stronger = 0;
  for (std::uint32_t k = 0; k < view.power_w.size(); ++k) {
    const double power_w = view.power_w[k];
    if (power_w > view.power_w[serving]) ++evaluation.stronger;
    if (k == serving || (count + 1 == compared_ && !(count > 0 && power_w > view.power_w[stations[count]]))) continue;
    if (count + 1 < compared_) ++count;
    std::uint32_t at = count;
    for (; at > 1 && power_w > view.power_w[stations[at - 1]]; --at) stations[at] = stations[at - 1];
    stations[at] = k;
  }
  const std::array<Compared, most_compared> old = evaluation.compared;
  const std::span known = std::span(old).first(evaluation.compared_count);
  evaluation.compared_count = count + 1;
  for (std::uint32_t i = 0; i <= count; ++i) {
    const auto same = std::ranges::find(known, stations[i], &Compared::station);
    evaluation.compared[i] = same != known.end() ? *same : Compared{.station = stations[i]};
  }
  evaluation.ranked = true;
}

void ReportLikelihood::compute(const Report& report, const View& view, Compared& cell) const {
  const double rise_m = report.height_m - scene_.city().base_station_height_m;
  cell.beam = beam_limits(scene_.model(), view.around.links[cell.station].distance_m, rise_m);
  const double per_w = 1.0 / view.power_w[cell.station];
  std::array<double, most_interferers> interference;
  std::size_t interferers = 0;
  for (std::uint32_t k = 0; k < view.power_w.size() && interferers < most_interferers; ++k)
    if (interferes(view, cell, k)) interference[interferers++] = view.power_w[k] * per_w;

  std::array<double, lanes> sinr{};
  std::ranges::copy(report.sinr, sinr.begin());
  std::array<double, lanes> exceeds;
  std::array<double, lanes> density;
  run_vectorised<distribution_loop>(scene_.model().noise_w * per_w, interference.data(), interferers, sinr.data(),
                                    exceeds.data(), density.data());
  for (std::size_t j = 0; j < most_sinrs; ++j)
    cell.density[j] = (1.0 - unexplained) * density[j] + unexplained / most_bit_s_hz;
  cell.below_least = (1.0 - unexplained) * (1.0 - exceeds[report.sinrs - 1]) + 0.5 * unexplained;
  cell.stale = false;
}

}  // namespace aloft::radio
