// Memories of agents, below their checksum: the first byte chooses the agent. What an agent accepts it can fly with,
// and it is the same after it was saved again.
#include <google/protobuf/stubs/logging.h>
#include <idl/agent_state.pb.h>

#include "common/base/digest.hpp"
#include "common/flight/flight.hpp"
#include "common/flight/testing/synthetic_map.hpp"
#include "tests/fuzz/remembering.hpp"
#include "tests/fuzz/target.hpp"

namespace {

using namespace aloft;

/// `content` as the state of this agent; unchanged where it is no Protobuf message.
std::string sealed(const agents::AgentSpec& spec, std::string content) {
  proto::AgentState state;
  if (state.ParseFromString(content)) {
    state.set_version(1);
    state.set_agent_type(spec.type);
    state.set_parameters_sha256(sha256_hex(spec.parameters.to_json().dump()));
    content = state.SerializeAsString();
  }
  proto::SealedAgentState file;
  file.set_state(content);
  file.set_sha256(sha256_hex(content));
  return file.SerializeAsString();
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const google::protobuf::LogSilencer quiet;  // it tells of invalid texts
  if (size == 0) return 0;
  const std::vector<agents::AgentSpec>& specs = fuzz::agents_with_state();
  const agents::AgentSpec& spec = specs[data[0] % specs.size()];
  const std::unique_ptr<agents::Agent> agent = spec.make();
  if (!fuzz::accepted([&] { agent->restore_state(sealed(spec, std::string(fuzz::text(data + 1, size - 1)))); }))
    return 0;
  const std::string saved = agent->save_state();
  const std::unique_ptr<agents::Agent> same = spec.make();
  same->restore_state(saved);
  fuzz::require(same->save_state() == saved, "an agent's memory changes when saved again");
  flight::SyntheticMap map = flight::SyntheticMap::random(radio::QosKind::throughput, 6, 5, 1);
  (void)flight::fly(map, 1, 0, *agent, spec);
  return 0;
}
