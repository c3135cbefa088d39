#include "python/src/environment.hpp"

#include <algorithm>
#include <utility>

#include "common/base/error.hpp"
#include "common/store/result_store.hpp"

namespace aloft::python {
namespace {

constexpr std::string_view pilot = "python";

}  // namespace

Environment::Environment(std::shared_ptr<const Worlds> worlds, const Layout& layout)
    : worlds_(std::move(worlds)), observer_(layout) {}

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
  observer_.begin(flight_->info());
  try {
    note_report(true);
  } catch (...) {
    flight_.reset();
    throw;
  }
}

void Environment::step(agents::Action action) {
  flight_->step({.action = action}, pilot);
  note_report(false);
}

void Environment::note_report(bool first) {
  if (observer_.layout().sites > 0)
    if (std::optional<agents::SiteMap> told = flight::survey(*flight_, agents::Privilege::site_map, first)) {
      if (first) observer_.survey(std::move(told->known.sites), told->radio->text("bs_antenna") == "sector");
      observer_.plan(told->step, std::move(told->route));
    }
  observer_.note(flight_->observation(), position());
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

std::string Environment::trace(std::string_view agent) const {
  flight::FlightRecord record = flight_->record();
  if (!record.pilots.empty()) record.pilots = {std::string(agent)};
  return store::encode_trace(record);
}

}  // namespace aloft::python
