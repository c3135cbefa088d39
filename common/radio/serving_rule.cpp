#include "common/radio/serving_rule.hpp"

#include <array>

namespace aloft::radio {
namespace {

enum class ServingRule : std::uint8_t { strongest, a3 };

constexpr std::array<Choice<ServingRule>, 2> serving_rules{
    {{"strongest", ServingRule::strongest}, {"a3", ServingRule::a3}}};

}  // namespace

ParameterSpec serving_parameter() {
  ParameterSpec spec = choice_parameter(
      "serving", serving_rules,
      "Which cell serves: at every place the strongest, as `serving_selection` says; or the one that the flight was "
      "handed over to by event A3 of 3GPP, with interruptions, ping-pongs and radio link failures.");
  spec.default_is_implied = true;  // worlds that were resolved before there was a choice do not name it
  return spec;
}

const std::vector<ParameterSpec>& a3_parameters() {
  constexpr A3Rules rules;
  static const std::vector<ParameterSpec> table{
      number_parameter("a3_offset_db", rules.offset_db, -15.0, 15.0,
                       "Serving `a3`: by so much a neighbour's received power must exceed that of the serving cell."),
      number_parameter("time_to_trigger_s", rules.time_to_trigger_s, 0.0, 5.12,
                       "Serving `a3`: for so long, before a handover is prepared."),
      integer_parameter("l3_filter_k", rules.l3_filter_k, 0, 19,
                        "Serving `a3`: layer-3 filter; a new measurement weighs 2^(-k/4), 0 is none."),
      number_parameter("l1_window_s", rules.l1_window_s, 0.04, 10.24,
                       "Serving `a3`: time over which layer 1 averages a measurement, and from one to the next."),
      number_parameter("measurement_error_db", rules.measurement_error_db, 0.0, 10.0,
                       "Serving `a3`: standard deviation of a measurement of received power."),
      number_parameter("handover_preparation_s", rules.preparation_s, 0.0, 5.0,
                       "Serving `a3`: from the trigger to the command; the old cell still serves."),
      number_parameter("handover_execution_s", rules.execution_s, 0.0, 5.0,
                       "Serving `a3`: from the command to the new cell; no cell serves."),
      number_parameter("minimum_stay_s", rules.minimum_stay_s, 0.0, 60.0,
                       "Serving `a3`: a handover back to the former cell before that is a ping-pong."),
      number_parameter("qout_db", rules.qout_db, -30.0, 30.0,
                       "Serving `a3`: below this SINR the link is out of sync, and no handover succeeds."),
      number_parameter("qin_db", rules.qin_db, -30.0, 30.0,
                       "Serving `a3`: from this SINR on the link is in sync again."),
      number_parameter("t310_s", rules.t310_s, 0.05, 60.0,
                       "Serving `a3`: a link that is out of sync for so long has failed."),
      number_parameter("reestablishment_s", rules.reestablishment_s, 0.0, 60.0,
                       "Serving `a3`: from a failed link to the next, at the strongest cell; no cell serves."),
  };
  return table;
}

std::optional<A3Rules> a3_rules(const Parameters& world) {
  if (world.chosen("serving", serving_rules) == ServingRule::strongest) return std::nullopt;
  return A3Rules{.offset_db = world.number("a3_offset_db"),
                 .time_to_trigger_s = world.number("time_to_trigger_s"),
                 .l3_filter_k = world.integer("l3_filter_k"),
                 .l1_window_s = world.number("l1_window_s"),
                 .measurement_error_db = world.number("measurement_error_db"),
                 .preparation_s = world.number("handover_preparation_s"),
                 .execution_s = world.number("handover_execution_s"),
                 .minimum_stay_s = world.number("minimum_stay_s"),
                 .qout_db = world.number("qout_db"),
                 .qin_db = world.number("qin_db"),
                 .t310_s = world.number("t310_s"),
                 .reestablishment_s = world.number("reestablishment_s")};
}

}  // namespace aloft::radio
