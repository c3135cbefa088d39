#pragma once

#include "common/experiment/experiment.hpp"

namespace aloft::experiment {

/// What the relays of an experiment must agree on with the rest of it: one name stands for one agent; nobody takes over
/// after the last step; somebody can take over where "on_agent_loss" is "failover", and nobody is aboard in vain where
/// it is "restart". InputError otherwise.
void check_relays(const Experiment& experiment);

}  // namespace aloft::experiment
