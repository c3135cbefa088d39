#include "python/src/observer.hpp"

#include <algorithm>
#include <utility>

namespace aloft::python {
namespace {

constexpr std::size_t report_values = values_of(report_fields);

}  // namespace

void Observer::begin(const agents::FlightInfo& flight) {
  flight_ = flight;
  empty_ = true;
  sites_.clear();
  route_.clear();
}

void Observer::survey(std::vector<world::Site> sites, bool sectors) {
  sites_ = std::move(sites);
  sectors_ = sectors;
}

void Observer::plan(std::uint32_t step, std::vector<world::Position> route) {
  route_step_ = step;
  route_ = std::move(route);
}

void Observer::note(const agents::Observation& report, world::Position uav) {
  step_ = report.step;
  uav_ = uav;
  std::ranges::copy_backward(std::span(reports_).first(reports_.size() - report_values), reports_.end());
  write_report(flight_, report, std::span(reports_).first(report_values));
  if (std::exchange(empty_, false))
    for (std::size_t at = report_values; at < reports_.size(); at += report_values)
      std::ranges::copy_n(reports_.begin(), report_values, reports_.begin() + static_cast<std::ptrdiff_t>(at));
}

void Observer::write(std::span<float> to) const {
  auto at = to.begin();
  std::size_t from = 0;
  for (const Field& field : report_fields) {
    for (std::size_t report = 0; report < reports_.size(); report += report_values)
      at = std::ranges::copy(std::span(reports_).subspan(report + from, field.values), at).out;
    from += field.values;
  }
  if (layout_.sites == 0) return;
  const std::size_t flown = step_ - route_step_;
  const std::span<const world::Position> route(route_);
  write_site_map(sites_, sectors_, uav_, route.subspan(std::min(flown, route.size())), layout_.sites,
                 to.subspan(reports_.size()));
}

}  // namespace aloft::python
