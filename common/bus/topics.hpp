#pragma once

#include <string_view>
#include <vector>

#include "common/bus/wire.hpp"
#include "common/security/keys.hpp"
#include "common/security/roles.hpp"

namespace aloft::bus {

using security::Role;
using security::Roles;

/// Where a topic is received: in the whole run, in one worker, or by those agents of one worker that may have the site
/// map, or that may see the future.
enum class Scope { run, worker, site_map, privileged };

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
  bool exclusive = false;        ///< readers get only the strongest live writer of a key; liveliness: 500 ms
  int spare = 0;                 ///< more samples per key at readers, so that writers do not displace each other's
};

/// The settings of a wire type's topic.
template <class T>
[[nodiscard]] const TopicSettings& topic_settings() noexcept;

/// The settings of all topics, in the order of topics.def.
[[nodiscard]] std::vector<const TopicSettings*> all_topics();
/// What `role` may write and read in a secured run.
[[nodiscard]] security::TopicRights topic_rights(Role role);

}  // namespace aloft::bus
