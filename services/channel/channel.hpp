#pragma once

#include <memory>

#include "common/bus/participant.hpp"
#include "common/bus/stop_signal.hpp"

namespace aloft::channel {

struct ChannelOptions {
  std::uint32_t lanes = 4;  ///< trials flown at the same time, 1 to 16
};

/// Flies the episodes of a worker's trials: asks agents, executes their commands, moves the UAVs, measures the radio,
/// and keeps every finished flight until it is stored.
class Channel {
 public:
  Channel(const bus::BusOptions& place, const ChannelOptions& options, bus::StopSignal& stop);
  ~Channel();
  Channel(const Channel&) = delete;
  Channel& operator=(const Channel&) = delete;

  /// Until the run ends or a stop is requested.
  void run();

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace aloft::channel
