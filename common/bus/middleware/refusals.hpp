#pragma once

// Fault of Fast DDS 2.9.1: it reports only in its log which topic a participant was not permitted to use. Upstream: no
// issue is known; 3.1.2 does not log two of these refusals at all. Can go when a listener gets them. That the text in
// the log is still recognised is tested by "intruders read and write nothing, and are named" in
// tests/integration/secured_run_test.cpp.

#include <string>

namespace aloft::bus {

/// What a message of the middleware says about a topic that a participant may not use, in words that name it; empty if
/// the message is about something else.
[[nodiscard]] std::string refusal_in_words(const std::string& message);

/// From now on the middleware's messages go to our log.
void take_over_log();

}  // namespace aloft::bus
