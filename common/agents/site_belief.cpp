#include "common/agents/site_belief.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "common/radio/approximations.hpp"

namespace aloft::agents {

using radio::ReportLikelihood;

namespace {

/// A move costs as much time as there are reports to fit. While they are few, this many times as many are tried at
/// most.
constexpr std::uint32_t most_times_moves = 5;
/// Moves are normal, with standard deviations between the error of the map and this many halvings of it.
constexpr double most_halvings = 1.5;

}  // namespace

SiteBelief::SiteBelief(const SiteSurvey& survey, const Settings& settings, const RandomStream& stream)
    : sites_(survey.map.sites),
      error_m_(survey.map.position_error_m),
      settings_(settings),
      likelihood_(survey.radio, sites_),
      stream_(stream),
      particles_(settings.particles) {
  for (Particle& particle : particles_) {
    particle.weight = 1.0 / settings_.particles;
    for (const world::Site& site : sites_) {
      const double x_m = site.position.x_m + error_m_ * stream_.normal();
      particle.stations.push_back({x_m, site.position.y_m + error_m_ * stream_.normal()});
    }
  }
}

void SiteBelief::learn(const ReportLikelihood::Report& report) {
  const std::size_t slot = learnt_++ % settings_.reports;
  if (slot >= reports_.size()) {
    reports_.resize(slot + 1);
    for (Particle& particle : particles_) particle.views.resize(slot + 1);
  }
  reports_[slot] = report;
  for (Particle& particle : particles_) {
    likelihood_.look(report, particle.stations, particle.views[slot]);
    particle.weight = radio::natural_log(particle.weight * particle.views[slot].evaluation.likelihood);
  }
  weigh();
  const std::uint32_t moves =
      settings_.moves * std::min(most_times_moves, settings_.reports / static_cast<std::uint32_t>(reports_.size()));
  for (Particle& particle : particles_) {
    list_movable(particle);
    for (std::uint32_t i = 0; i < moves && !movable_.empty(); ++i)
      try_move(particle, movable_[stream_.uniform_index(static_cast<std::uint32_t>(movable_.size()))]);
  }
}

/// Makes weights of their logarithms, and draws particles again if their effective number is below half.
void SiteBelief::weigh() {
  constexpr double least = 1e-12;  // so that logarithms stay finite
  double largest = particles_.front().weight;
  for (const Particle& particle : particles_) largest = std::max(largest, particle.weight);
  double sum = 0.0;
  for (Particle& particle : particles_) {
    const double log_weight = std::max(particle.weight - largest, -100.0);
    particle.weight = std::max(radio::exp2(log_weight / std::numbers::ln2), least);
    sum += particle.weight;
  }
  double sum_of_squares = 0.0;
  for (Particle& particle : particles_) {
    particle.weight /= sum;
    sum_of_squares += particle.weight * particle.weight;
  }
  if (2.0 > sum_of_squares * settings_.particles) return;
  resample();
}

void SiteBelief::resample() {
  const std::vector<Particle> old = particles_;
  const std::vector<std::size_t> drawn = draw();
  for (std::size_t i = 0; i < drawn.size(); ++i) {
    if (drawn[i] != i) particles_[i] = old[drawn[i]];
    particles_[i].weight = 1.0 / settings_.particles;
  }
}

/// Systematic resampling (Kitagawa 1996).
std::vector<std::size_t> SiteBelief::draw() {
  const std::size_t count = particles_.size();
  std::vector<std::size_t> drawn;
  const double share = 1.0 / static_cast<double>(count);
  double next = share * stream_.uniform();
  double sum = 0.0;
  for (std::size_t i = 0; i < particles_.size(); ++i) {
    sum += particles_[i].weight;
    const bool last = i + 1 == particles_.size();
    for (; drawn.size() < count && (last || next < sum); next += share) drawn.push_back(i);
  }
  return drawn;
}

/// The sites that matter to one of the last reports, and more often those that may have been reported: of the others,
/// nothing is known but the map.
void SiteBelief::list_movable(const Particle& particle) {
  movable_.clear();
  for (std::uint32_t k = 0; k < sites_.size(); ++k)
    if (std::ranges::any_of(particle.views, [&](const auto& view) { return likelihood_.matters(view, k); }))
      movable_.push_back(k);
  for (const ReportLikelihood::View& view : particle.views)
    for (std::uint32_t i = 0; i < view.evaluation.compared_count; ++i)
      movable_.push_back(view.evaluation.compared[i].station);
}

double SiteBelief::squared_deviations(std::uint32_t station, world::Position position) const noexcept {
  const double x = (position.x_m - sites_[station].position.x_m) / error_m_;
  const double y = (position.y_m - sites_[station].position.y_m) / error_m_;
  return x * x + y * y;
}

/// Metropolis et al. 1953: takes the move with the probability min(1, ratio of the posterior densities).
void SiteBelief::try_move(Particle& particle, std::uint32_t station) {
  world::Position& place = particle.stations[station];
  constexpr double least_ratio = 1e-100;
  const double step_m = error_m_ * radio::exp2(-most_halvings * stream_.uniform());
  const double dx_m = step_m * stream_.normal();
  const world::Position to{place.x_m + dx_m, place.y_m + step_m * stream_.normal()};
  double log_ratio = 0.5 * (squared_deviations(station, place) - squared_deviations(station, to));
  double ratio = 1.0;
  undo_.resize(reports_.size());
  for (std::size_t i = 0; i < reports_.size(); ++i) {
    ReportLikelihood::View& view = particle.views[i];
    const double before = view.evaluation.likelihood;
    likelihood_.move(reports_[i], station, to, view, undo_[i]);
    ratio *= view.evaluation.likelihood / before;
    if (ratio > least_ratio && ratio < 1.0 / least_ratio) continue;
    log_ratio += radio::natural_log(ratio);  // before it overflows
    ratio = 1.0;
  }
  if (radio::natural_log(stream_.uniform()) < log_ratio + radio::natural_log(ratio)) {
    place = to;
    return;
  }
  for (std::size_t i = 0; i < reports_.size(); ++i) ReportLikelihood::take_back(undo_[i], station, particle.views[i]);
}

void SiteBelief::save(StateWriter& writer) const {
  writer.put_integer("stream", stream_.position());
  writer.put_integer("learnt", learnt_);
  std::vector<double> numbers;
  for (const ReportLikelihood::Report& report : reports_) {
    numbers.insert(numbers.end(), {report.place.x_m, report.place.y_m, report.height_m,
                                   static_cast<double>(report.serving), static_cast<double>(report.sinrs)});
    numbers.insert(numbers.end(), report.sinr.begin(), report.sinr.end());
  }
  writer.put("reports", std::span<const double>(numbers));
  numbers.clear();
  for (const Particle& particle : particles_) {
    numbers.push_back(particle.weight);
    for (const world::Position& station : particle.stations) numbers.insert(numbers.end(), {station.x_m, station.y_m});
  }
  writer.put("particles", std::span<const double>(numbers));
}

void SiteBelief::restore(const StateReader& reader) {
  stream_.seek(reader.integer("stream"));
  learnt_ = reader.integer("learnt");
  restore_reports(reader);
  const auto numbers = reader.doubles("particles");
  const std::size_t each = 1 + 2 * sites_.size();
  if (numbers.size() != each * particles_.size()) reader.refuse("its maps are not as many or as large as they must be");
  if (!std::ranges::all_of(numbers, [](double number) { return std::isfinite(number); }))
    reader.refuse("its maps have a number that is not finite");
  for (std::size_t i = 0; i < particles_.size(); ++i) {
    const auto own = numbers.subspan(i * each, each);
    Particle& particle = particles_[i];
    particle.weight = own[0];
    if (!(particle.weight > 0.0)) reader.refuse("one of its maps has no weight");
    for (std::size_t k = 0; k < sites_.size(); ++k) particle.stations[k] = {own[1 + 2 * k], own[2 + 2 * k]};
    particle.views.resize(reports_.size());
    for (std::size_t j = 0; j < reports_.size(); ++j)
      likelihood_.look(reports_[j], particle.stations, particle.views[j]);
  }
}

void SiteBelief::restore_reports(const StateReader& reader) {
  const auto numbers = reader.doubles("reports");
  constexpr std::size_t each = 5 + ReportLikelihood::most_sinrs;
  if (numbers.size() != each * std::min<std::uint64_t>(learnt_, settings_.reports))
    reader.refuse("its reports are not as many as it says");
  reports_.clear();
  for (std::size_t i = 0; i < numbers.size(); i += each) {
    const auto own = numbers.subspan(i, each);
    if (!std::ranges::all_of(own, [](double number) { return std::isfinite(number); }) || own[3] < 0.0 ||
        own[3] >= static_cast<double>(sites_.size()) || own[4] < 1.0 || own[4] > ReportLikelihood::most_sinrs)
      reader.refuse("it has an impossible report");
    ReportLikelihood::Report& report = reports_.emplace_back();
    report = {{own[0], own[1]}, own[2], static_cast<std::uint32_t>(own[3]), static_cast<std::uint32_t>(own[4]), {}};
    std::ranges::copy(own.subspan(5), report.sinr.begin());
  }
}

}  // namespace aloft::agents
