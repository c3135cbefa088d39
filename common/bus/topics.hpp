#pragma once

#include <array>
#include <string_view>
#include <vector>

#include "common/bus/wire.hpp"

namespace aloft::bus {

/// Who hears a topic: the whole run, one worker, or those in one worker that may see the future.
enum class Scope { run, worker, privileged };

/// What a process is for. In a secured run it decides which topics the process may write and read.
enum class Role : unsigned {
  coordinator = 1U << 0U,
  metrics = 1U << 1U,
  environment = 1U << 2U,
  channel = 1U << 3U,
  learning_agent = 1U << 4U,
  baseline_agent = 1U << 5U,
  observer = 1U << 6U,      ///< the command line: reads how runs go
  run_operator = 1U << 7U,  ///< the command line: orders swaps
};
inline constexpr std::array all_roles{Role::coordinator, Role::metrics,        Role::environment,
                                      Role::channel,     Role::learning_agent, Role::baseline_agent,
                                      Role::observer,    Role::run_operator};

/// "learning-agent"; the program of a role is "aloft-" and this.
[[nodiscard]] std::string_view to_text(Role role) noexcept;
/// InputError, listing all, if there is no such role.
[[nodiscard]] Role role_from_text(std::string_view text);

/// Several of them.
struct Roles {
  unsigned bits = 0;

  constexpr Roles(Role role) noexcept : bits(static_cast<unsigned>(role)) {}  // NOLINT: one role is a set of one
  [[nodiscard]] constexpr bool contain(Role role) const noexcept { return (bits & static_cast<unsigned>(role)) != 0; }
};
[[nodiscard]] constexpr Roles operator|(Roles a, Roles b) noexcept {
  a.bits |= b.bits;
  return a;
}

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
