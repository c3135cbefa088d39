#pragma once

#include <optional>
#include <vector>

#include "common/base/parameters.hpp"

namespace aloft::radio {

/// How a network of 3GPP hands a UAV over, and when the UAV loses its radio link. The defaults of the handover are
/// those of TR 36.777, table A.2.1-1; those of radio link failures are those of TR 36.839, 5.2, except
/// reestablishment_s, which is an assumption: the search for a known cell and the reading of its system information, as
/// in TS 36.133, 6.1.
struct A3Rules {
  double offset_db = 2.0;              ///< by which a neighbour must be stronger than the serving cell
  double time_to_trigger_s = 0.16;     ///< for so long
  int l3_filter_k = 1;                 ///< TS 36.331, 5.5.3.2: a new measurement weighs 2^(-k/4)
  double l1_window_s = 0.2;            ///< one measurement of all cells per window
  double measurement_error_db = 1.22;  ///< its standard deviation
  double preparation_s = 0.05;         ///< from the trigger to the command: the old cell serves
  double execution_s = 0.04;           ///< from the command to the new cell: none serves
  double minimum_stay_s = 1.0;         ///< a return to the former cell before that is a ping-pong
  double qout_db = -8.0;               ///< SINR below which the link counts as out of sync
  double qin_db = -6.0;                ///< SINR from which on it counts as in sync again
  double t310_s = 1.0;                 ///< a link that is out of sync for so long has failed
  double reestablishment_s = 0.25;     ///< after a failure, none serves for so long
};

/// Parameter `serving` of a generated world, with its default at the front of its choices.
[[nodiscard]] ParameterSpec serving_parameter();
/// The values of A3Rules: keys of generated worlds with serving "a3", in addition to those of every world.
[[nodiscard]] const std::vector<ParameterSpec>& a3_parameters();

/// Nothing: the strongest cell serves at every place. `world`: resolved by resolve_generated_world().
[[nodiscard]] std::optional<A3Rules> a3_rules(const Parameters& world);

}  // namespace aloft::radio
