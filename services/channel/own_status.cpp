#include "services/channel/own_status.hpp"

#include <unistd.h>

#include <chrono>

#include "common/base/limits.hpp"
#include "common/base/process_name.hpp"
#include "common/bus/answer_times.hpp"

namespace aloft::channel {

OwnStatus::OwnStatus(std::string_view worker, const std::vector<std::string>& flies_only) {
  status_.worker(wire::name(worker));
  status_.host(wire::name(this_process().host));
  status_.pid(static_cast<std::uint32_t>(getpid()));
  status_.incarnation(static_cast<std::uint64_t>(std::chrono::system_clock::now().time_since_epoch().count()));
  status_.flies_only(wire::names(flies_only));
}

void OwnStatus::count_step(double answer_s) {
  ++status_.steps_done();
  ++status_.answer_counts()[bus::answer_bucket(answer_s)];
  status_.answer_s() += answer_s;
}

void OwnStatus::count_flight() {
  ++status_.flights_done();
}

void OwnStatus::add_failure(std::uint64_t lease, std::string_view reason) {
  auto& failures = status_.failures();
  if (failures.size() == limits::failures_told) failures.erase(failures.begin());
  failures.emplace_back();
  failures.back().lease_id(lease);
  failures.back().reason(wire::message(reason));
}

wire::WorkerStatus OwnStatus::next() {
  ++status_.heartbeat();
  return status_;
}

}  // namespace aloft::channel
