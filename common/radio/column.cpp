#include "common/radio/column.hpp"

#include <algorithm>
#include <limits>
#include <numeric>
#include <utility>

#include "common/radio/height_rows.hpp"

namespace aloft::radio {
namespace {

constexpr std::uint32_t lanes = Fading::lanes;

}  // namespace

ColumnBuilder::ColumnBuilder(const Scene& scene, const Fading& fading, const Assumptions& assumed)
    : scene_(scene),
      fading_(fading),
      assumed_(assumed),
      heights_(scene.heights().size()),
      width_((heights_ + lanes - 1) / lanes * lanes),
      ranks_(scene.reported_stations()),
      power_w_(scene.stations()),
      by_distance_(scene.stations()),
      ranked_power_w_(std::size_t{ranks_} * width_),
      ranked_(std::size_t{ranks_} * width_),
      sinr_(std::size_t{ranks_} * width_),
      slots_(scene.stations()),
      interference_w_(width_) {
  for (std::uint32_t i = 0; i < width_; ++i) {
    height_m_.push_back(scene.heights().height_m(i));
    rise_m_.push_back(scene.rise_m(i));
  }
}

std::vector<Reading> ColumnBuilder::build(std::uint32_t point, world::Position position) {
  compute_sinrs(point, position);
  return choose_serving();
}

void ColumnBuilder::sum_candidates(std::uint32_t point, world::Position position, double* efficiency) {
  compute_sinrs(point, position);
  std::vector<double>& sum = moving_;
  sum.assign(heights_, 0.0);
  for (std::uint32_t rank = 0; rank < scene_.serving_candidates(); ++rank)
    for (std::uint32_t i = 0; i < heights_; ++i) sum[i] += sinr_[std::size_t{rank} * width_ + i];
  spectral_efficiency_row(sum, scene_.model().efficiency_max, efficiency);
}

void ColumnBuilder::compute_sinrs(std::uint32_t point, world::Position position) {
  scene_.look_around(position, around_);
  first_los_.assign(scene_.stations(), std::nullopt);
  power_known_.assign(scene_.stations(), 0);
  if (ranks_ == scene_.stations())
    rank_all();
  else
    rank_strongest();
  collect_slots();
  for (const std::uint32_t c : involved_) compute_sinr(point, c);
}

std::uint32_t ColumnBuilder::first_los(std::uint32_t k) {
  if (assumed_.line_of_sight) return 0;
  auto& known = first_los_[k];
  if (!known) known = scene_.first_los(scene_.link_model().blocking_height_m(Scene::link(around_, k)));
  return *known;
}

const double* ColumnBuilder::power_w(std::uint32_t k) {
  std::vector<double>& row = power_w_[k];
  if (power_known_[k] == 0) {
    row.resize(width_);
    scene_.received_power_row(around_, k, height_m_, rise_m_, first_los(k), row.data());
    power_known_[k] = 1;
  }
  return row.data();
}

/// Ranks the strongest stations at every height, by power, then index. It begins with the nearest, so that most of the
/// others can be skipped without computing their power.
void ColumnBuilder::rank_strongest() {
  std::fill(ranked_power_w_.begin(), ranked_power_w_.end(), -1.0);
  std::iota(by_distance_.begin(), by_distance_.end(), 0U);
  std::sort(by_distance_.begin(), by_distance_.end(), [this](std::uint32_t a, std::uint32_t b) {
    return std::pair(around_.links[a].distance_m, a) < std::pair(around_.links[b].distance_m, b);
  });
  for (const std::uint32_t k : by_distance_)
    if (may_be_among_strongest(k))
      rank_station_row(k, {power_w(k), heights_}, ranks_, width_, ranked_power_w_.data(), ranked_.data(), moving_);
}

/// False if station k cannot be among the strongest: its link's upper bound of power is too small at every height, both
/// with and without line of sight.
bool ColumnBuilder::may_be_among_strongest(std::uint32_t k) {
  const double* weakest_w = ranked_power_w_.data() + std::size_t{ranks_ - 1} * width_;
  const auto may_be = [&](std::span<const double> among_w, bool line_of_sight) {
    if (among_w.empty()) return false;
    const double gain_bound = scene_.gain_bound(Scene::link(around_, k), line_of_sight);
    return any_at_most(among_w, power_bound_w(scene_.model(), gain_bound));
  };
  const std::uint32_t los = std::min(first_los(k), heights_);
  return may_be({weakest_w, los}, false) || may_be({weakest_w + los, heights_ - los}, true);
}

/// The same order as rank_strongest() by sorting, for when all stations are wanted at every height.
void ColumnBuilder::rank_all() {
  for (std::uint32_t k = 0; k < ranks_; ++k) static_cast<void>(power_w(k));  // fills power_w_
  for (std::uint32_t i = 0; i < heights_; ++i) {
    std::iota(by_distance_.begin(), by_distance_.end(), 0U);
    std::stable_sort(by_distance_.begin(), by_distance_.end(),
                     [&](std::uint32_t a, std::uint32_t b) { return power_w_[a][i] > power_w_[b][i]; });
    for (std::uint32_t rank = 0; rank < ranks_; ++rank) ranked_[std::size_t{rank} * width_ + i] = by_distance_[rank];
  }
}

/// Lists the wanted SINRs by base station.
void ColumnBuilder::collect_slots() {
  for (const std::uint32_t c : involved_) slots_[c].clear();
  involved_.clear();
  for (std::uint32_t i = 0; i < heights_; ++i) {
    for (std::uint32_t rank = 0; rank < ranks_; ++rank) {
      const auto c = static_cast<std::uint32_t>(ranked_[std::size_t{rank} * width_ + i]);
      if (slots_[c].empty()) involved_.push_back(c);
      slots_[c].push_back({i, rank});
    }
  }
}

/// SINR_c = p_c f_c / (N + sum of p_k f_ck over interferers k, in ascending order).
void ColumnBuilder::compute_sinr(std::uint32_t point, std::uint32_t c) {
  select_blocks(c);
  fading_.want(point, c, c, blocks_);
  disturbed_blocks_.clear();
  disturber_w_.clear();
  for (std::uint32_t k = 0; k < scene_.stations(); ++k)
    if (scene_.can_interfere(around_, c, k)) add_interferer(point, c, k);
  const std::span<const double> fading = fading_.take(point);

  for (const std::uint32_t block : blocks_) std::fill_n(interference_w_.begin() + block * lanes, lanes, 0.0);
  add_interference(disturber_w_, disturbs_.data(), fading.data() + blocks_.size() * lanes, disturbed_blocks_.data(),
                   interference_w_.data());
  const double* power = power_w(c);
  std::size_t block_position = 0;
  for (const Slot& slot : slots_[c]) {
    while (blocks_[block_position] < slot.height / lanes) ++block_position;
    const double interference_w = interference_w_[slot.height];
    sinr_[std::size_t{slot.rank} * width_ + slot.height] =
        power[slot.height] * fading[block_position * lanes + slot.height % lanes] /
        (scene_.model().noise_w + interference_w) * (interference_w == 0.0 ? assumed_.undisturbed : 1.0);
  }
}

/// Lists the blocks of four heights where the SINR of c is wanted, and computes the UAV's beam there.
void ColumnBuilder::select_blocks(std::uint32_t c) {
  blocks_.clear();
  wanted_.resize(width_);
  block_rise_m_.resize(width_);
  for (const Slot& slot : slots_[c]) {
    const std::uint32_t block = slot.height / lanes;
    if (blocks_.empty() || blocks_.back() != block) {
      std::fill_n(wanted_.begin() + blocks_.size() * lanes, lanes, 0.0);
      std::copy_n(rise_m_.begin() + block * lanes, lanes, block_rise_m_.begin() + blocks_.size() * lanes);
      blocks_.push_back(block);
    }
    wanted_[(blocks_.size() - 1) * lanes + slot.height % lanes] = 1.0;
  }
  wanted_.resize(blocks_.size() * lanes);
  block_rise_m_.resize(blocks_.size() * lanes);
  nearest_m_.assign(block_rise_m_.size(), 0.0);
  farthest_m_.assign(block_rise_m_.size(), std::numeric_limits<double>::infinity());
  if (scene_.model().uav_antenna == UavAntenna::directional)
    beam_limits_row(scene_.model(), around_.links[c].distance_m, block_rise_m_, nearest_m_.data(), farthest_m_.data());
}

/// Adds the blocks in which k interferes with c, and requests its fading there.
void ColumnBuilder::add_interferer(std::uint32_t point, std::uint32_t c, std::uint32_t k) {
  const std::size_t first = disturbed_blocks_.size();
  disturbs_.resize(std::max(disturbs_.size(), first * lanes + wanted_.size()));
  double* const rows = disturbs_.data() + first * lanes;
  disturbance_row(around_.links[k].distance_m, wanted_, nearest_m_.data(), farthest_m_.data(), rows);
  std::size_t disturbed = 0;
  for (std::size_t b = 0; b < blocks_.size(); ++b) {
    const double* row = rows + b * lanes;
    if (row[0] + row[1] + row[2] + row[3] == 0.0) continue;
    disturbed_blocks_.push_back(blocks_[b]);
    if (disturbed != b) std::copy_n(row, lanes, rows + disturbed * lanes);
    ++disturbed;
  }
  if (disturbed == 0) return;
  disturber_w_.resize(first + disturbed, power_w(k));
  fading_.want(point, c, k, std::span(disturbed_blocks_).subspan(first));
}

/// The serving cell is the candidate with the best SINR; the neighbours are the best of the others, descending.
std::vector<Reading> ColumnBuilder::choose_serving() {
  const std::uint32_t neighbours = std::min(scene_.model().neighbours, ranks_ - 1);
  std::vector<double> chosen(std::size_t{neighbours + 1} * heights_, -1.0);  // [serving, neighbours...][height]
  serving_rank_.resize(heights_);
  best_row(sinr_, scene_.serving_candidates(), width_, std::span(chosen).first(heights_), serving_rank_.data());
  others_.resize(heights_);
  neighbour_ranks_.resize(chosen.size());
  for (std::uint32_t rank = 0; rank < ranks_; ++rank) {
    others_row({sinr_.data() + std::size_t{rank} * width_, heights_}, rank, serving_rank_.data(), others_.data());
    rank_station_row(rank, others_, neighbours, heights_, chosen.data() + heights_, neighbour_ranks_.data(), moving_);
  }

  std::vector<Reading> readings(heights_);
  std::vector<double> efficiency(heights_);
  spectral_efficiency_row(std::span(chosen).first(heights_), scene_.model().efficiency_max, efficiency.data());
  decibel_row(chosen, chosen.data());
  for (std::uint32_t i = 0; i < heights_; ++i) {
    const auto serving = static_cast<std::size_t>(serving_rank_[i]);
    readings[i].serving_cell = static_cast<std::int32_t>(ranked_[serving * width_ + i]);
    readings[i].neighbour_count = neighbours;
    readings[i].qos = efficiency[i];
    readings[i].serving_sinr_db = chosen[i];
    for (std::uint32_t j = 0; j < neighbours; ++j)
      readings[i].neighbour_sinr_db.at(j) = chosen[std::size_t{j + 1} * heights_ + i];
  }
  return readings;
}

}  // namespace aloft::radio
