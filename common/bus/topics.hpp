#pragma once

#include <string_view>

#include "common/bus/wire.hpp"

namespace aloft::bus {

/// Who hears a topic: the whole run, one worker, or those in one worker that may see the future.
enum class Scope { run, worker, privileged };

/// One row of the table of topics: every decision about a topic's quality of service. All topics are reliable and
/// published synchronously.
struct TopicSettings {
  std::string_view name;
  Scope scope = Scope::run;
  bool transient_local = false;  ///< late joiners get the last samples
  int depth = 1;                 ///< samples kept per key; the oldest gives way, so that write() never waits
  int keys = 1;                  ///< live keys; 1: the type has no key
  bool exclusive = false;        ///< only the strongest live writer of a key is heard; it proves life every 500 ms
};

/// The row of a wire type.
template <class T>
[[nodiscard]] const TopicSettings& topic_settings() noexcept;

}  // namespace aloft::bus
