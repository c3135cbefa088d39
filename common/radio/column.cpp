#include "common/radio/column.hpp"

#include <algorithm>
#include <array>

#include "common/radio/height_rows.hpp"

namespace aloft::radio {
namespace {

constexpr std::uint32_t lanes = Fading::lanes;

}  // namespace

ColumnBuilder::ColumnBuilder(const Scene& scene, const Fading& fading)
    : scene_(scene),
      fading_(fading),
      heights_(scene.heights().size()),
      width_((heights_ + lanes - 1) / lanes * lanes),
      ranks_(scene.reported_stations()),
      power_w_(std::size_t{scene.stations()} * width_),
      ranked_power_w_(std::size_t{ranks_} * width_),
      ranked_(std::size_t{ranks_} * width_),
      sinr_(std::size_t{ranks_} * width_),
      slots_(scene.stations()),
      interference_w_(width_) {
  for (std::uint32_t i = 0; i < width_; ++i) rise_m_.push_back(scene.rise_m(i));
}

std::vector<Reading> ColumnBuilder::build(std::uint32_t point, world::Position position) {
  scene_.look_around(position, around_);
  for (std::uint32_t k = 0; k < scene_.stations(); ++k) {
    const Link& link = around_.links[k];
    received_power_row(scene_.model(), link.distance_m, rise_m_, scene_.first_los(link),
                       power_w_.data() + std::size_t{k} * width_);
  }
  if (ranks_ == scene_.stations())
    rank_among_all();
  else
    rank_stations();

  involved_.clear();
  for (std::uint32_t i = 0; i < heights_; ++i) {
    for (std::uint32_t rank = 0; rank < ranks_; ++rank) {
      const std::uint32_t c = ranked_[std::size_t{rank} * width_ + i];
      if (slots_[c].empty()) involved_.push_back(c);
      slots_[c].push_back({i, rank});
    }
  }
  for (const std::uint32_t c : involved_) {
    compute_sinr(point, c);
    slots_[c].clear();
  }
  return choose_serving();
}

/// The strongest stations at every height, by power, then index.
void ColumnBuilder::rank_stations() {
  std::fill(ranked_power_w_.begin(), ranked_power_w_.end(), -1.0);
  for (std::uint32_t k = 0; k < scene_.stations(); ++k) insert(k, power_w(k));
}

void ColumnBuilder::insert(std::uint32_t k, const double* power_w) {
  const double* weakest_w = ranked_power_w_.data() + std::size_t{ranks_ - 1} * width_;
  for (std::uint32_t i = 0; i < heights_; ++i) {
    if (power_w[i] <= weakest_w[i]) continue;
    std::uint32_t rank = ranks_ - 1;
    for (; rank > 0 && power_w[i] > ranked_power_w_[std::size_t{rank - 1} * width_ + i]; --rank) {
      ranked_power_w_[std::size_t{rank} * width_ + i] = ranked_power_w_[std::size_t{rank - 1} * width_ + i];
      ranked_[std::size_t{rank} * width_ + i] = ranked_[std::size_t{rank - 1} * width_ + i];
    }
    ranked_power_w_[std::size_t{rank} * width_ + i] = power_w[i];
    ranked_[std::size_t{rank} * width_ + i] = k;
  }
}

/// All stations are wanted at every height: the same order by power, by sorting.
void ColumnBuilder::rank_among_all() {
  std::vector<std::uint32_t> order(ranks_);
  for (std::uint32_t i = 0; i < heights_; ++i) {
    for (std::uint32_t k = 0; k < ranks_; ++k) order[k] = k;
    std::stable_sort(order.begin(), order.end(),
                     [&](std::uint32_t a, std::uint32_t b) { return power_w(a)[i] > power_w(b)[i]; });
    for (std::uint32_t rank = 0; rank < ranks_; ++rank) ranked_[std::size_t{rank} * width_ + i] = order[rank];
  }
}

/// SINR_c = p_c f_c / (N + sum of p_k f_ck over interferers k, in ascending order).
void ColumnBuilder::compute_sinr(std::uint32_t point, std::uint32_t c) {
  select_blocks(c);
  for (const std::uint32_t block : blocks_) std::fill_n(interference_w_.begin() + block * lanes, lanes, 0.0);
  for (std::uint32_t k = 0; k < scene_.stations(); ++k)
    if (scene_.can_interfere(around_, c, k)) add_interferer(point, c, k);

  fading_.rows(point, c, c, blocks_, fading_row_);
  std::size_t block_position = 0;
  for (const Slot& slot : slots_[c]) {
    while (blocks_[block_position] < slot.height / lanes) ++block_position;
    const double fading = fading_row_[block_position * lanes + slot.height % lanes];
    sinr_[std::size_t{slot.rank} * width_ + slot.height] =
        power_w(c)[slot.height] * fading / (scene_.model().noise_w + interference_w_[slot.height]);
  }
}

/// The blocks of four heights where the SINR of c is wanted, and the UAV's beam there.
void ColumnBuilder::select_blocks(std::uint32_t c) {
  blocks_.clear();
  wanted_.clear();
  block_rise_m_.clear();
  for (const Slot& slot : slots_[c]) {
    const std::uint32_t block = slot.height / lanes;
    if (blocks_.empty() || blocks_.back() != block) {
      blocks_.push_back(block);
      wanted_.resize(blocks_.size() * lanes, 0);
      block_rise_m_.insert(block_rise_m_.end(), rise_m_.begin() + block * lanes, rise_m_.begin() + (block + 1) * lanes);
    }
    wanted_[(blocks_.size() - 1) * lanes + slot.height % lanes] = 1;
  }
  nearest_m_.assign(block_rise_m_.size(), 0.0);
  farthest_m_.assign(block_rise_m_.size(), std::numeric_limits<double>::infinity());
  if (scene_.model().uav_antenna == UavAntenna::directional)
    beam_limits_row(scene_.model(), around_.links[c].distance_m, block_rise_m_, nearest_m_.data(), farthest_m_.data());
}

void ColumnBuilder::add_interferer(std::uint32_t point, std::uint32_t c, std::uint32_t k) {
  const double distance_m = around_.links[k].distance_m;
  disturbed_blocks_.clear();
  disturbs_.clear();
  for (std::size_t b = 0; b < blocks_.size(); ++b) {
    std::array<double, lanes> disturbs{};
    bool any = false;
    for (std::uint32_t lane = 0; lane < lanes; ++lane) {
      const std::size_t i = b * lanes + lane;
      const bool hit = wanted_[i] != 0 && BeamLimits{nearest_m_[i], farthest_m_[i]}.contain(distance_m);
      disturbs.at(lane) = hit ? 1.0 : 0.0;
      any |= hit;
    }
    if (!any) continue;
    disturbed_blocks_.push_back(blocks_[b]);
    disturbs_.insert(disturbs_.end(), disturbs.begin(), disturbs.end());
  }
  fading_.rows(point, c, k, disturbed_blocks_, fading_row_);
  const double* power = power_w(k);
  for (std::size_t b = 0; b < disturbed_blocks_.size(); ++b) {
    const std::size_t height = std::size_t{disturbed_blocks_[b]} * lanes;
    for (std::uint32_t lane = 0; lane < lanes; ++lane)
      interference_w_[height + lane] +=
          disturbs_[b * lanes + lane] * (power[height + lane] * fading_row_[b * lanes + lane]);
  }
}

/// Serving cell: the best SINR of the candidates. Neighbours: the best of the others, descending.
std::vector<Reading> ColumnBuilder::choose_serving() {
  const std::uint32_t neighbours = std::min(scene_.model().neighbours, ranks_ - 1);
  std::vector<double> chosen(std::size_t{neighbours + 1} * heights_);  // [serving, neighbours...][height]
  std::vector<Reading> readings(heights_);
  for (std::uint32_t i = 0; i < heights_; ++i) {
    const auto sinr = [&](std::uint32_t rank) { return sinr_[std::size_t{rank} * width_ + i]; };
    std::uint32_t serving = 0;
    for (std::uint32_t rank = 1; rank < scene_.serving_candidates(); ++rank)
      if (sinr(rank) > sinr(serving)) serving = rank;
    chosen[i] = sinr(serving);
    std::array<double, agents::max_neighbours + 1> best{};
    std::uint32_t count = 0;
    for (std::uint32_t rank = 0; rank < ranks_; ++rank) {
      if (rank == serving || (count == neighbours && (count == 0 || sinr(rank) <= best.at(count - 1)))) continue;
      std::uint32_t at = count < neighbours ? count++ : count - 1;
      for (; at > 0 && sinr(rank) > best.at(at - 1); --at) best.at(at) = best.at(at - 1);
      best.at(at) = sinr(rank);
    }
    for (std::uint32_t j = 0; j < neighbours; ++j) chosen[std::size_t{j + 1} * heights_ + i] = best.at(j);
    readings[i].serving_cell = static_cast<std::int32_t>(ranked_[std::size_t{serving} * width_ + i]);
    readings[i].neighbour_count = neighbours;
  }

  std::vector<double> efficiency(heights_);
  spectral_efficiency_row(std::span(chosen).first(heights_), efficiency.data());
  decibel_row(chosen, chosen.data());
  for (std::uint32_t i = 0; i < heights_; ++i) {
    readings[i].qos = efficiency[i];
    readings[i].serving_sinr_db = chosen[i];
    for (std::uint32_t j = 0; j < neighbours; ++j)
      readings[i].neighbour_sinr_db.at(j) = chosen[std::size_t{j + 1} * heights_ + i];
  }
  return readings;
}

}  // namespace aloft::radio
