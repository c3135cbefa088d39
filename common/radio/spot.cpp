#include "common/radio/spot.hpp"

#include <algorithm>
#include <functional>
#include <limits>
#include <numeric>

#include "common/radio/height_rows.hpp"

namespace aloft::radio {

SpotBuilder::SpotBuilder(const Scene& scene, const Fading& fading)
    : scene_(scene),
      fading_(fading),
      rows_(scene.city().base_stations),
      covers_(scene.stations(), 1.0),
      power_w_(scene.stations()),
      blocked_power_w_(scene.stations()),
      disturbs_(scene.stations(), 1.0) {}

Reading SpotBuilder::build(std::uint32_t point, world::Position position, std::uint32_t height) {
  look(position, height);
  rank_strongest(scene_.reported_stations());
  find_interferers(scene_.rise_m(height));
  compute_sinrs(point, height);
  return choose_serving();
}

void SpotBuilder::scan(std::uint32_t point, world::Position position, std::uint32_t height,
                       std::span<const std::int32_t> also, CellScan& into) {
  look(position, height);
  const RadioModel& model = scene_.model();
  rank_strongest(std::min(scene_.stations(), std::max(model.candidates, model.neighbours + 1)));
  for (const std::int32_t cell : also) add_rank(cell);
  find_interferers(scene_.rise_m(height));
  compute_sinrs(point, height);
  into.neighbours = model.neighbours;
  into.cells.resize(ranked_.size());
  for (std::size_t rank = 0; rank < ranked_.size(); ++rank) {
    constexpr double dbm_of_1_w = 30.0;
    into.cells[rank] = {static_cast<std::int32_t>(ranked_[rank]), decibel(power_w_[ranked_[rank]]) + dbm_of_1_w,
                        decibel(sinr_[rank]), spectral_efficiency(sinr_[rank], model.efficiency_max)};
  }
}

void SpotBuilder::look(world::Position position, std::uint32_t height) {
  look_from(position, rows_);
  if (scene_.model().bs_antenna == BsAntenna::sector)
    sector_row(scene_.model(), scene_.sector_boresights(), rows_, covers_.data());
  if (scene_.model().bs_antenna == BsAntenna::tr_38_901) azimuth_loss_row(scene_.sector_boresights(), rows_);
  compute_powers(position, height);
}

void SpotBuilder::compute_powers(world::Position position, std::uint32_t height) {
  const double height_m = scene_.heights().height_m(height);
  const LinkModel& model = scene_.link_model();
  model.mean_gains(position, rows_.distance_m, true, height_m, power_w_.data());
  model.mean_gains(position, rows_.distance_m, false, height_m, blocked_power_w_.data());
  LinkPlace link{.uav = position};
  for (; link.station < scene_.stations(); ++link.station) {
    link.distance_m = rows_.distance_m[link.station];
    const bool line_of_sight = model.line_of_sight(link, height_m);
    if (!line_of_sight) power_w_[link.station] = blocked_power_w_[link.station];
    scene_.shadow(link, line_of_sight, std::span(&height_m, 1), &power_w_[link.station]);
  }
  received_powers(scene_.model(), rows_, scene_.rise_m(height), power_w_.data());
}

void SpotBuilder::rank_strongest(std::uint32_t count) {
  ranked_.resize(scene_.stations());
  std::iota(ranked_.begin(), ranked_.end(), 0U);
  const auto stronger = [this](std::uint32_t a, std::uint32_t b) {
    return power_w_[a] > power_w_[b] || (power_w_[a] == power_w_[b] && a < b);
  };
  std::partial_sort(ranked_.begin(), ranked_.begin() + count, ranked_.end(), stronger);
  ranked_.resize(count);
}

void SpotBuilder::add_rank(std::int32_t cell) {
  const auto station = static_cast<std::uint32_t>(cell);
  if (std::ranges::find(ranked_, station) == ranked_.end()) ranked_.push_back(station);
}

void SpotBuilder::find_interferers(double rise_m) {
  pairs_.clear();
  links_.clear();
  for (const std::uint32_t c : ranked_) {
    if (scene_.model().uav_antenna == UavAntenna::directional)
      beam_row(scene_.model(), rows_, c, beam_limits(scene_.model(), rows_.distance_m[c], rise_m), disturbs_.data());
    const std::size_t first = pairs_.size();
    pairs_.resize(first + 1 + scene_.stations());
    std::uint32_t* next = pairs_.data() + first;
    *next++ = Fading::pair(c, c);
    for (std::uint32_t k = 0; k < scene_.stations(); ++k) {
      *next = Fading::pair(c, k);
      next += k != c && disturbs_[k] * covers_[k] != 0.0 ? 1 : 0;
    }
    pairs_.resize(static_cast<std::size_t>(next - pairs_.data()));
    links_.push_back(pairs_.size());
  }
}

/// SINR_c = p_c f_c / (N + sum of p_k f_ck over interferers k, in ascending order).
void SpotBuilder::compute_sinrs(std::uint32_t point, std::uint32_t height) {
  const std::span<const double> fading = fading_.at_height(point, pairs_, height);
  sinr_.resize(ranked_.size());
  std::size_t link = 0;
  for (std::size_t rank = 0; rank < ranked_.size(); ++rank) {
    const std::uint32_t c = ranked_[rank];
    const double wanted_w = power_w_[c] * fading[link++];
    double interference_w = 0.0;
    for (; link < links_[rank]; ++link) interference_w += power_w_[pairs_[link] % Fading::max_stations] * fading[link];
    sinr_[rank] = wanted_w / (scene_.model().noise_w + interference_w);
  }
}

/// The serving cell is the candidate with the best SINR; the neighbours are the best of the others, descending.
Reading SpotBuilder::choose_serving() {
  const auto candidates_end = sinr_.begin() + scene_.serving_candidates();
  const auto serving = std::max_element(sinr_.begin(), candidates_end);
  Reading reading;
  reading.serving_cell = static_cast<std::int32_t>(ranked_[static_cast<std::size_t>(serving - sinr_.begin())]);
  reading.neighbour_count = std::min<std::uint32_t>(scene_.model().neighbours, scene_.reported_stations() - 1);
  spectral_efficiency_row({&*serving, 1}, scene_.model().efficiency_max, &reading.qos);
  std::iter_swap(sinr_.begin(), serving);
  const auto end = sinr_.begin() + 1 + reading.neighbour_count;
  std::partial_sort(sinr_.begin() + 1, end, sinr_.end(), std::greater());
  reported_.resize(1 + reading.neighbour_count);
  decibel_row(std::span(sinr_).first(reported_.size()), reported_.data());
  reading.serving_sinr_db = reported_[0];
  std::copy(reported_.begin() + 1, reported_.end(), reading.neighbour_sinr_db.begin());
  return reading;
}

}  // namespace aloft::radio
