#include "common/bus/topics.hpp"

namespace aloft::bus {
namespace {

// Streams of a worker: agents of an experiment (at most 64) times lanes.
constexpr int max_streams = 1024;
constexpr int max_workers = 1024;

}  // namespace

// clang-format off
//                                                                             name               scope              transient depth  keys         exclusive
template <> const TopicSettings& topic_settings<wire::RunControl>() noexcept      { static constexpr TopicSettings row{"RunControl",      Scope::run,        true,  1,    1,           false}; return row; }
template <> const TopicSettings& topic_settings<wire::TrialAssignment>() noexcept { static constexpr TopicSettings row{"TrialAssignment", Scope::run,        true,  64,   max_workers, false}; return row; }
template <> const TopicSettings& topic_settings<wire::WorkerStatus>() noexcept    { static constexpr TopicSettings row{"WorkerStatus",    Scope::run,        true,  1,    max_workers, false}; return row; }
template <> const TopicSettings& topic_settings<wire::RunStatus>() noexcept       { static constexpr TopicSettings row{"RunStatus",       Scope::run,        true,  1,    1,           false}; return row; }
template <> const TopicSettings& topic_settings<wire::EpisodeRecord>() noexcept   { static constexpr TopicSettings row{"EpisodeRecord",   Scope::run,        false, 512,  1,           false}; return row; }
template <> const TopicSettings& topic_settings<wire::EpisodeStored>() noexcept   { static constexpr TopicSettings row{"EpisodeStored",   Scope::run,        false, 4096, 1,           false}; return row; }
template <> const TopicSettings& topic_settings<wire::RecordRefused>() noexcept   { static constexpr TopicSettings row{"RecordRefused",   Scope::run,        false, 64,   1,           false}; return row; }
template <> const TopicSettings& topic_settings<wire::MemoryRequest>() noexcept   { static constexpr TopicSettings row{"MemoryRequest",   Scope::run,        false, 1024, 1,           false}; return row; }
template <> const TopicSettings& topic_settings<wire::StoredMemory>() noexcept    { static constexpr TopicSettings row{"StoredMemory",    Scope::run,        false, 64,   1,           false}; return row; }
template <> const TopicSettings& topic_settings<wire::CollectorStatus>() noexcept { static constexpr TopicSettings row{"CollectorStatus", Scope::run,        true,  1,    1,           false}; return row; }
template <> const TopicSettings& topic_settings<wire::World>() noexcept           { static constexpr TopicSettings row{"World",           Scope::worker,     false, 64,   1,           false}; return row; }
template <> const TopicSettings& topic_settings<wire::ChannelReport>() noexcept   { static constexpr TopicSettings row{"ChannelReport",   Scope::worker,     false, 8,    max_streams, false}; return row; }
template <> const TopicSettings& topic_settings<wire::HeightCommand>() noexcept   { static constexpr TopicSettings row{"HeightCommand",   Scope::worker,     false, 8,    max_streams, true};  return row; }
template <> const TopicSettings& topic_settings<wire::AgentStatus>() noexcept     { static constexpr TopicSettings row{"AgentStatus",     Scope::worker,     true,  1,    max_streams, false}; return row; }
template <> const TopicSettings& topic_settings<wire::FlightMemory>() noexcept    { static constexpr TopicSettings row{"FlightMemory",    Scope::worker,     false, 64,   1,           false}; return row; }
template <> const TopicSettings& topic_settings<wire::HeightProfile>() noexcept   { static constexpr TopicSettings row{"HeightProfile",   Scope::privileged, false, 16384, max_streams, false}; return row; }
// clang-format on

}  // namespace aloft::bus
