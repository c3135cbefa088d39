#include "common/bus/topics.hpp"

#include "common/base/limits.hpp"

namespace aloft::bus {
namespace {

// RunControl samples of other writers that a reader keeps beside the coordinator's: a process that starts late waits
// for the coordinator's.
constexpr int strangers_samples = 15;

constexpr Roles coordinator = Role::coordinator;
constexpr Roles metrics = Role::metrics;
constexpr Roles environment = Role::environment;
constexpr Roles channel = Role::channel;
constexpr Roles baseline_agent = Role::baseline_agent;
constexpr Roles observer = Role::observer;
constexpr Roles run_operator = Role::run_operator;
constexpr Roles agents = Roles(Role::learning_agent) | baseline_agent;
constexpr Roles everyone = coordinator | metrics | environment | channel | agents | observer | run_operator;

}  // namespace

#define ALOFT_BARE(...) __VA_ARGS__
#define ALOFT_TOPIC(type, settings, ...)                                    \
  template <>                                                               \
  const TopicSettings& topic_settings<wire::type>() noexcept {              \
    static constexpr TopicSettings row{.name = #type, ALOFT_BARE settings}; \
    return row;                                                             \
  }
#include "common/bus/topics.def"

std::vector<const TopicSettings*> all_topics() {
  return {
#define ALOFT_TOPIC(type, ...) &topic_settings<wire::type>(),
#include "common/bus/topics.def"
  };
}

security::TopicRights topic_rights(Role role) {
  security::TopicRights rights;
  for (const TopicSettings* topic : all_topics()) {
    if (topic->writers.contain(role)) rights.writes.push_back(topic->name);
    if (topic->readers.contain(role)) rights.reads.push_back(topic->name);
  }
  return rights;
}

}  // namespace aloft::bus
