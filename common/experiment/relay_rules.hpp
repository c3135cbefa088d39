#pragma once

#include "common/experiment/experiment.hpp"

namespace aloft::experiment {

/// Checks the relays of an experiment (InputError): one name means one agent; no member takes over after the last step;
/// with "on_agent_loss" "failover" there is an agent that can take over, with "restart" every member gets to fly.
void check_relays(const Experiment& experiment);

}  // namespace aloft::experiment
