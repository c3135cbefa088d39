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

/// What a row of the table of topics (topics.def) says beside the limits of a sample: every decision about a topic's
/// quality of service. All topics are reliable and published synchronously.
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

/// The settings of a wire type's topic.
template <class T>
[[nodiscard]] const TopicSettings& topic_settings() noexcept;

/// Those of all topics, in the order of topics.def.
[[nodiscard]] std::vector<const TopicSettings*> all_topics();
/// What `role` may write and read in a secured run.
[[nodiscard]] security::TopicRights topic_rights(Role role);

}  // namespace aloft::bus
