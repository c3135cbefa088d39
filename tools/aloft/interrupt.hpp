#pragma once

#include <atomic>

namespace aloft::cli {

/// From now on Ctrl-C and SIGTERM do not end this process but set the flag that is returned.
const std::atomic<bool>& note_interrupts();

}  // namespace aloft::cli
