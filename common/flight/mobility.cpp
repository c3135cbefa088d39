#include "common/flight/mobility.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <utility>

#include "common/radio/approximations.hpp"

namespace aloft::flight {
namespace {

using radio::CellReading;

std::chrono::microseconds microseconds(double time_s) {
  return std::chrono::microseconds(std::llround(1e6 * time_s));
}

/// 2^(-k/4).
double filter_weight(int l3_filter_k) {
  constexpr std::array<double, 4> quarters{1.0, 0.84089641525371454, 0.70710678118654752, 0.59460355750136053};
  return std::ldexp(quarters.at(static_cast<std::size_t>(l3_filter_k % 4)), -(l3_filter_k / 4));
}

}  // namespace

Mobility::Mobility(const radio::A3Rules& rules, std::uint64_t seed, std::uint32_t trial, double step_s,
                   double outage_threshold_db)
    : rules_(rules),
      outage_threshold_db_(outage_threshold_db),
      weight_of_new_(filter_weight(rules.l3_filter_k)),
      step_(microseconds(step_s)),
      errors_(seed, trial, "measurement error") {}

void Mobility::begin(std::span<const CellReading> cells) {
  cells_ = cells;
  hear();
  for (std::size_t i = 0; i < cells.size(); ++i) heard_[i].before_dbm = cells[i].power_dbm;
  cells_ = {};
  serving_ = std::ranges::max_element(cells, {}, &CellReading::power_dbm)->cell;
  followed_ = {serving_};
}

Mobility::Passage Mobility::pass(std::span<const CellReading> cells) {
  cells_ = cells;
  passage_ = {};
  out_ = Time{0};
  step_began_ = now_;
  hear();
  watch_link();
  const Time end = now_ + step_;
  while (true) {
    const Time timer = next_timer();
    const Time next = std::min({timer, next_measurement_, end});
    spend(next);
    if (timer == next)
      run_timer();
    else if (next == end)
      break;
    else
      measure();
  }
  settle();
  passage_.events.outage_s = static_cast<double>(out_.count()) / 1e6;
  for (Heard& heard : heard_) heard.before_dbm = here(heard.cell).power_dbm;
  followed_ = {serving_};
  if (state_ == State::preparing) followed_.push_back(other_);
  cells_ = {};
  return passage_;
}

/// Forgets the cells that are not heard at the present place; the power of a new one is taken to be what it is here.
void Mobility::hear() {
  std::vector<Heard> now;
  for (const CellReading& cell : cells_) {
    const auto known = std::ranges::find(heard_, cell.cell, &Heard::cell);
    now.push_back(known == heard_.end() ? Heard{.cell = cell.cell, .before_dbm = cell.power_dbm} : *known);
  }
  heard_ = std::move(now);
}

const CellReading& Mobility::here(std::int32_t cell) const {
  const auto found = std::ranges::find(cells_, cell, &CellReading::cell);
  if (found == cells_.end()) throw std::logic_error("a cell that the UAV follows is not among those of the place");
  return *found;
}

/// When a neighbour has been stronger for long enough, the link fails, or the state ends, whichever is first.
Mobility::Time Mobility::next_timer() const {
  Time next = link_fails_.value_or(Time::max());
  if (state_ != State::connected) next = std::min(next, state_ends_);
  for (const Heard& heard : heard_)
    if (heard.stronger_since) next = std::min(next, *heard.stronger_since + microseconds(rules_.time_to_trigger_s));
  return next;
}

void Mobility::spend(Time until) {
  const Time span = until - now_;
  now_ = until;
  if (serves()) served_ += span;
  if (!serves() || here(serving_).sinr_db < outage_threshold_db_) out_ += span;
}

/// The time served in whole, so that a step with one cell has exactly its quality.
void Mobility::settle() {
  passage_.qos += here(serving_).qos * (static_cast<double>(served_.count()) / static_cast<double>(step_.count()));
  served_ = Time{0};
}

void Mobility::run_timer() {
  if (link_fails_ == now_) return fail();
  switch (state_) {
    case State::connected:
      return prepare();
    case State::preparing:
      return execute();
    case State::executing:
      return complete();
    case State::reestablishing:
      return connect(-1);
  }
}

void Mobility::measure() {
  for (Heard& heard : heard_) {
    const double new_dbm = measured_dbm(heard);
    heard.filtered_dbm =
        heard.filtered_dbm ? (1.0 - weight_of_new_) * *heard.filtered_dbm + weight_of_new_ * new_dbm : new_dbm;
  }
  ++measurements_;
  next_measurement_ += microseconds(rules_.l1_window_s);
  if (state_ == State::connected) compare_neighbours();
}

/// The power where the UAV is now, with an error (Box-Muller) that depends on the measurement and the cell alone.
double Mobility::measured_dbm(const Heard& heard) const {
  const double share = static_cast<double>((now_ - step_began_).count()) / static_cast<double>(step_.count());
  const double power_dbm = heard.before_dbm + share * (here(heard.cell).power_dbm - heard.before_dbm);
  const auto words = errors_.block(measurements_, static_cast<std::uint32_t>(heard.cell), 0);
  const double radius = std::sqrt(-2.0 * radio::natural_log(unit_interval(words[0])));
  return power_dbm + rules_.measurement_error_db * radius * radio::cos_pi(2.0 * unit_interval(words[1]) - 1.0);
}

/// Event A3: a neighbour enters above the serving cell's power plus the offset, and leaves below.
void Mobility::compare_neighbours() {
  const double bar_dbm = *std::ranges::find(heard_, serving_, &Heard::cell)->filtered_dbm + rules_.offset_db;
  for (Heard& heard : heard_) {
    if (heard.cell == serving_) continue;
    if (*heard.filtered_dbm < bar_dbm)
      heard.stronger_since.reset();
    else if (*heard.filtered_dbm > bar_dbm && !heard.stronger_since)
      heard.stronger_since = now_;
  }
}

void Mobility::watch_link() {
  if (!serves()) return;
  const double sinr_db = here(serving_).sinr_db;
  if (sinr_db >= rules_.qin_db)
    link_fails_.reset();
  else if (sinr_db < rules_.qout_db && !link_fails_)
    link_fails_ = now_ + microseconds(rules_.t310_s);
}

/// Towards the strongest of the neighbours that have been stronger for long enough.
void Mobility::prepare() {
  const Heard* strongest = nullptr;
  for (const Heard& heard : heard_)
    if (heard.stronger_since && *heard.stronger_since + microseconds(rules_.time_to_trigger_s) <= now_ &&
        (strongest == nullptr || *heard.filtered_dbm > *strongest->filtered_dbm))
      strongest = &heard;
  other_ = strongest->cell;
  enter(State::preparing, microseconds(rules_.preparation_s));
}

void Mobility::execute() {
  if (here(serving_).sinr_db < rules_.qout_db) return fail();
  settle();
  std::swap(serving_, other_);
  enter(State::executing, microseconds(rules_.execution_s));
}

void Mobility::complete() {
  if (here(serving_).sinr_db < rules_.qout_db) return fail();
  ++passage_.events.handovers;
  if (serving_ == former_ && now_ - connected_since_ < microseconds(rules_.minimum_stay_s))
    ++passage_.events.ping_pongs;
  connect(other_);
}

void Mobility::fail() {
  ++passage_.events.radio_link_failures;
  settle();
  serving_ = std::ranges::max_element(heard_, {}, [](const Heard& heard) {
               return heard.filtered_dbm.value_or(-std::numeric_limits<double>::infinity());
             })->cell;
  enter(State::reestablishing, microseconds(rules_.reestablishment_s));
}

void Mobility::connect(std::int32_t former) {
  former_ = former;
  connected_since_ = now_;
  enter(State::connected, Time{0});
  watch_link();
}

void Mobility::enter(State state, Time duration) {
  state_ = state;
  state_ends_ = now_ + duration;
  for (Heard& heard : heard_) heard.stronger_since.reset();
  if (!serves()) link_fails_.reset();
}

}  // namespace aloft::flight
