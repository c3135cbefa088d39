#include "common/bus/topics.hpp"

#include "common/base/limits.hpp"

namespace aloft::bus {
namespace {

constexpr int max_streams = limits::streams;
constexpr int all_steps = limits::steps;
constexpr int max_workers = limits::workers;
// Of a stranger's RunControl beside the coordinator's, for which a process that starts late waits.
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

// clang-format off
//                                                                                                                     name               writers       readers                                                        scope              tr.loc depth  keys         exclusive
template <> const TopicSettings& topic_settings<wire::RunControl>() noexcept      { static constexpr TopicSettings row{"RunControl",      coordinator,  everyone,                                                      Scope::run,        true,  1,     1,           false, strangers_samples}; return row; }
template <> const TopicSettings& topic_settings<wire::TrialAssignment>() noexcept { static constexpr TopicSettings row{"TrialAssignment", coordinator,  environment,                                                   Scope::run,        true,  64,    max_workers, false}; return row; }
template <> const TopicSettings& topic_settings<wire::WorkerStatus>() noexcept    { static constexpr TopicSettings row{"WorkerStatus",    channel,      coordinator | metrics | environment | observer | run_operator, Scope::run,        true,  1,     max_workers, false}; return row; }
template <> const TopicSettings& topic_settings<wire::RunStatus>() noexcept       { static constexpr TopicSettings row{"RunStatus",       coordinator,  metrics | observer,                                            Scope::run,        true,  1,     1,           false}; return row; }
template <> const TopicSettings& topic_settings<wire::EpisodeRecord>() noexcept   { static constexpr TopicSettings row{"EpisodeRecord",   channel,      metrics,                                                       Scope::run,        false, 512,   1,           false}; return row; }
template <> const TopicSettings& topic_settings<wire::EpisodeStored>() noexcept   { static constexpr TopicSettings row{"EpisodeStored",   metrics,      coordinator | channel,                                         Scope::run,        false, 4096,  1,           false}; return row; }
template <> const TopicSettings& topic_settings<wire::RecordRefused>() noexcept   { static constexpr TopicSettings row{"RecordRefused",   metrics,      channel,                                                       Scope::run,        false, 64,    1,           false}; return row; }
template <> const TopicSettings& topic_settings<wire::MemoryRequest>() noexcept   { static constexpr TopicSettings row{"MemoryRequest",   agents,       metrics,                                                       Scope::run,        false, 1024,  1,           false}; return row; }
template <> const TopicSettings& topic_settings<wire::StoredMemory>() noexcept    { static constexpr TopicSettings row{"StoredMemory",    metrics,      agents,                                                        Scope::run,        false, 64,    1,           false}; return row; }
template <> const TopicSettings& topic_settings<wire::CollectorStatus>() noexcept { static constexpr TopicSettings row{"CollectorStatus", metrics,      coordinator | observer,                                        Scope::run,        true,  4,     1,           false}; return row; }
template <> const TopicSettings& topic_settings<wire::SwapRequest>() noexcept     { static constexpr TopicSettings row{"SwapRequest",     run_operator, channel,                                                       Scope::worker,     false, 64,    1,           false}; return row; }
template <> const TopicSettings& topic_settings<wire::SwapReply>() noexcept       { static constexpr TopicSettings row{"SwapReply",       channel,      run_operator,                                                  Scope::worker,     false, 64,    1,           false}; return row; }
template <> const TopicSettings& topic_settings<wire::World>() noexcept           { static constexpr TopicSettings row{"World",           environment,  channel,                                                       Scope::worker,     false, 64,    1,           false}; return row; }
template <> const TopicSettings& topic_settings<wire::ChannelReport>() noexcept   { static constexpr TopicSettings row{"ChannelReport",   channel,      agents,                                                        Scope::worker,     false, 8,     max_streams, false}; return row; }
template <> const TopicSettings& topic_settings<wire::HeightCommand>() noexcept   { static constexpr TopicSettings row{"HeightCommand",   agents,       channel,                                                       Scope::worker,     false, 8,     max_streams, true}; return row; }
template <> const TopicSettings& topic_settings<wire::ReportFollowed>() noexcept  { static constexpr TopicSettings row{"ReportFollowed",  agents,       channel,                                                       Scope::worker,     false, 1024,  1,           false}; return row; }
template <> const TopicSettings& topic_settings<wire::AgentStatus>() noexcept     { static constexpr TopicSettings row{"AgentStatus",     agents,       channel,                                                       Scope::worker,     true,  1,     max_streams, false}; return row; }
template <> const TopicSettings& topic_settings<wire::FlightMemory>() noexcept    { static constexpr TopicSettings row{"FlightMemory",    agents,       channel,                                                       Scope::worker,     false, 64,    1,           false}; return row; }
template <> const TopicSettings& topic_settings<wire::HeightProfile>() noexcept   { static constexpr TopicSettings row{"HeightProfile",   channel,      baseline_agent,                                                Scope::privileged, false, all_steps, max_streams, false}; return row; }
// clang-format on

std::vector<const TopicSettings*> all_topics() {
#define ALOFT_BUS_ROW(T) &topic_settings<wire::T>(),
  return {ALOFT_BUS_TOPICS(ALOFT_BUS_ROW)};
#undef ALOFT_BUS_ROW
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
