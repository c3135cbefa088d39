#include "python/src/environment.hpp"

#include <algorithm>
#include <utility>

#include "common/base/error.hpp"
#include "common/store/result_store.hpp"

namespace aloft::python {
namespace {

constexpr std::size_t report_values = values_of(report_fields);
constexpr std::string_view pilot = "python";

}  // namespace

Environment::Environment(std::shared_ptr<const Worlds> worlds, const Layout& layout)
    : worlds_(std::move(worlds)), layout_(layout), reports_(layout.reports()) {}

void Environment::begin(const Start& start) {
  flight_.reset();
  const bool same_map =
      map_ && start.condition == start_.condition && (start == start_ || worlds_->measured(start.condition));
  if (!same_map) {
    map_.reset();
    map_ = worlds_->map(start.condition, start.seed, start.trial);
  }
  start_ = start;
  costs_ = worlds_->costs(start.condition);
  flight_.emplace(*map_, start.seed, start.trial, costs_);
  last_cell_ = -1;
  handover_ = false;
  try {
    note_report(true);
  } catch (...) {
    flight_.reset();
    throw;
  }
}

void Environment::step(agents::Action action) {
  flight_->step({.action = action}, pilot);
  const std::int32_t cell = flight_->observation().serving_cell;
  handover_ = cell >= 0 && last_cell_ >= 0 && cell != last_cell_;
  if (cell >= 0) last_cell_ = cell;
  note_report(false);
}

void Environment::note_report(bool first) {
  std::ranges::copy_backward(std::span(reports_).first(reports_.size() - report_values), reports_.end());
  write_report(flight_->info(), flight_->observation(), reports_);
  if (first)
    for (std::size_t at = report_values; at < reports_.size(); at += report_values)
      std::ranges::copy_n(reports_.begin(), report_values, reports_.begin() + static_cast<std::ptrdiff_t>(at));
  if (layout_.sites == 0) return;
  std::optional<agents::SiteMap> told = flight::survey(*flight_, agents::Privilege::site_map, first);
  if (!told) return;
  if (first) {
    sectors_ = told->radio->text("bs_antenna") == "sector";
    sites_ = std::move(told->known.sites);
  }
  site_map_ = std::move(*told);
}

world::Position Environment::position() const {
  if (flight_->record().steps.empty()) return origin();
  const flight::StepRecord& last = flight_->record().steps.back();
  return {last.x_m, last.y_m};
}

std::vector<world::Position> Environment::route() const {
  std::vector<world::Position> all;
  for (std::uint32_t step = 1; step <= map_->steps(); ++step)
    all.push_back(map_->advance(map_->result_point(step), map_->start(), -1));
  return all;
}

double Environment::energy_j() const {
  return flight_->record().step_energy_j(flight_->record().steps.size() - 1, costs_);
}

std::vector<agents::HeightProfile> Environment::profiles() const {
  if (!flight_->fixed_route())
    throw InputError("the route depends on the flight, so its quality is not known beforehand");
  std::vector<agents::HeightProfile> all(flight_->info().steps);
  for (std::uint32_t i = 0; i < all.size(); ++i) flight_->profile(i + 1, all[i]);
  return all;
}

void Environment::write_observation(std::span<float> to) const {
  auto at = to.begin();
  std::size_t from = 0;
  for (const Field& field : report_fields) {
    for (std::size_t report = 0; report < reports_.size(); report += report_values)
      at = std::ranges::copy(std::span(reports_).subspan(report + from, field.values), at).out;
    from += field.values;
  }
  if (layout_.sites == 0) return;
  const std::size_t flown = flight_->observation().step - site_map_.step;
  const std::span<const world::Position> route(site_map_.route);
  write_site_map(sites_, sectors_, position(), route.subspan(std::min(flown, route.size())), layout_.sites,
                 to.subspan(reports_.size()));
}

std::string Environment::trace(std::string_view agent) const {
  flight::FlightRecord record = flight_->record();
  if (!record.pilots.empty()) record.pilots = {std::string(agent)};
  return store::encode_trace(record);
}

}  // namespace aloft::python
