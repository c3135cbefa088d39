#pragma once

#include <cstdint>
#include <string>

#include "common/base/stop_signal.hpp"
#include "common/bus/participant.hpp"

namespace aloft::cli {

/// One order to the channel of one worker.
struct SwapOrder {
  bus::BusOptions place;  ///< with the worker; the role is set by order_swap
  std::string agent;
  std::uint32_t at_step = 0;  ///< 0: the next one
  unsigned limit_s = 10;
};

/// Gives the order and waits until the agent commands every flight that it was ordered to; with `at_step`, until the
/// order is accepted. Returns what has happened, as a sentence; empty if a stop was requested. InputError if there is
/// no such worker or it refuses, std::runtime_error if the time runs out.
[[nodiscard]] std::string order_swap(SwapOrder order, StopSignal& stop);

}  // namespace aloft::cli
