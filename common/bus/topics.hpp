#pragma once

#include <string_view>
#include <vector>

#include "common/bus/wire.hpp"
#include "common/security/keys.hpp"
#include "common/security/roles.hpp"

namespace aloft::bus {

using security::Role;
using security::Roles;

/// Who hears a topic: the whole run, one worker, or those in one worker that may see the future.
enum class Scope { run, worker, privileged };

/// One row of the table of topics: every decision about a topic's quality of service. All topics are reliable and
/// published synchronously.
struct TopicSettings {
  std::string_view name;
  Roles writers;  ///< in a secured run
  Roles readers;  ///< in a secured run
  Scope scope = Scope::run;
  bool transient_local = false;  ///< late joiners get the last samples
  int depth = 1;                 ///< samples kept per key; the oldest gives way, so that write() never waits
  int keys = 1;                  ///< live keys; 1: the type has no key
  bool exclusive = false;        ///< only the strongest live writer of a key is heard; it proves life every 500 ms
  int spare = 0;                 ///< samples per key that readers keep beyond `depth`: one writer displaces no other's
};

/// The row of a wire type.
template <class T>
[[nodiscard]] const TopicSettings& topic_settings() noexcept;

/// All rows.
[[nodiscard]] std::vector<const TopicSettings*> all_topics();
/// What `role` may write and read in a secured run.
[[nodiscard]] security::TopicRights topic_rights(Role role);

/// Every wire type that has a topic: a new one has its row in topics.cpp and its name here.
#define ALOFT_BUS_TOPICS(X) \
  X(RunControl)             \
  X(TrialAssignment)        \
  X(WorkerStatus)           \
  X(RunStatus)              \
  X(EpisodeRecord)          \
  X(EpisodeStored)          \
  X(RecordRefused)          \
  X(FlightMemory)           \
  X(MemoryRequest)          \
  X(StoredMemory)           \
  X(CollectorStatus)        \
  X(World)                  \
  X(ChannelReport)          \
  X(HeightCommand)          \
  X(ReportFollowed)         \
  X(SwapRequest)            \
  X(SwapReply)              \
  X(AgentStatus)            \
  X(HeightProfile)

}  // namespace aloft::bus
