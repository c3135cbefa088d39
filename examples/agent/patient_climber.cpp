// An agent outside of Aloft's sources: climbs while the quality rises, and turns around when it has fallen several
// times.
#include <cstdint>
#include <memory>
#include <vector>

#include "common/agents/plugin.hpp"
#include "common/agents/steering.hpp"

namespace {

using namespace aloft::agents;  // NOLINT(google-build-using-namespace): an example
using aloft::Parameters;

class PatientClimber final : public SteeringAgent {
 public:
  explicit PatientClimber(const Parameters& parameters)
      : SteeringAgent("patient-climber", parameters),
        patience_(static_cast<unsigned>(parameters.integer("patience"))) {}

  void begin(const FlightInfo& flight) override {
    SteeringAgent::begin(flight);
    up_ = true;
    failures_ = 0;
    last_qos_ = 0.0;
  }

  void observe(const Observation& observation) override {
    SteeringAgent::observe(observation);
    if (observation.step == 0) return;  // nothing was flown yet
    failures_ = observation.qos < last_qos_ ? failures_ + 1 : 0;
    last_qos_ = observation.qos;
    if (failures_ < patience_) return;
    up_ = !up_;
    failures_ = 0;
  }

  Command act() override { return {up_ ? Action::up : Action::down}; }

 private:
  void save(StateWriter& writer) const override {
    writer.put_integer("up", up_ ? 1 : 0);
    writer.put_integer("failures", failures_);
    writer.put_number("last_qos", last_qos_);
  }

  void restore(const StateReader& reader) override {
    up_ = reader.integer("up") != 0;
    failures_ = static_cast<unsigned>(reader.integer("failures"));
    last_qos_ = reader.number("last_qos");
  }

  unsigned patience_;
  bool up_ = true;
  unsigned failures_ = 0;  ///< steps in a row after which the quality was worse
  double last_qos_ = 0.0;
};

std::vector<AgentType> agents() {
  return {
      {.name = "patient-climber",
       .description = "Climbs while the quality rises, and turns around when it has fallen several times in a row.",
       .parameters = {aloft::integer_parameter("patience", 3, 1, 100, "Falls in a row after which it turns around.")},
       .make = [](const Parameters& parameters) { return std::make_unique<PatientClimber>(parameters); }}};
}

}  // namespace

ALOFT_PLUGIN(agents);
