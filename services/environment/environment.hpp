#pragma once

#include <memory>

#include "common/base/stop_signal.hpp"
#include "common/bus/participant.hpp"

namespace aloft::environment {

/// Turns the trials that are leased to its worker into worlds: a generated city, or a measured flight.
class Environment {
 public:
  Environment(const bus::BusOptions& place, StopSignal& stop);
  ~Environment();
  Environment(const Environment&) = delete;
  Environment& operator=(const Environment&) = delete;

  /// Returns when the run is over or a stop is requested.
  void run();

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace aloft::environment
