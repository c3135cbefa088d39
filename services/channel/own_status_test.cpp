#include "services/channel/own_status.hpp"

#include <unistd.h>

#include <catch2/catch.hpp>

#include "common/base/limits.hpp"
#include "common/bus/answer_times.hpp"
#include "common/bus/validate.hpp"

namespace aloft::channel {

TEST_CASE("every status is the next heartbeat of one process") {
  OwnStatus own("w3", {"dqn", "planner"});
  own.begin("0123456789abcdef");
  const wire::WorkerStatus first = own.next();
  CHECK(wire::view(first.worker()) == "w3");
  CHECK(wire::view(first.experiment_id()) == "0123456789abcdef");
  CHECK(first.pid() == static_cast<std::uint32_t>(getpid()));
  CHECK(first.heartbeat() == 1);
  CHECK(wire::texts(first.flies_only()) == std::vector<std::string>{"dqn", "planner"});
  CHECK(bus::validate(first) == nullptr);
  const wire::WorkerStatus second = own.next();
  CHECK(second.heartbeat() == 2);
  CHECK(second.incarnation() == first.incarnation());
}

TEST_CASE("a status counts what was flown, and how long the agents took") {
  OwnStatus own("w0", {});
  own.count_step(30e-6);
  own.count_step(40e-6);
  own.count_step(2.0);
  own.count_flight();
  const wire::WorkerStatus status = own.next();
  CHECK(status.steps_done() == 3);
  CHECK(status.flights_done() == 1);
  CHECK(status.answer_s() == Approx(2.00007));
  CHECK(status.answer_counts()[bus::answer_bucket(30e-6)] == 2);
  CHECK(status.answer_counts().back() == 1);
  CHECK(status.failures().empty());
}

TEST_CASE("a status reports the latest failures, oldest first, as many as fit") {
  OwnStatus own("w0", {});
  for (std::uint64_t lease = 1; lease <= limits::failures_told + 2; ++lease) own.add_failure(lease, "lost");
  const wire::WorkerStatus status = own.next();
  REQUIRE(status.failures().size() == limits::failures_told);
  CHECK(status.failures().front().lease_id() == 3);
  CHECK(status.failures().back().lease_id() == limits::failures_told + 2);
  CHECK(wire::view(status.failures().back().reason()) == "lost");
  CHECK(bus::validate(status) == nullptr);
}

}  // namespace aloft::channel
