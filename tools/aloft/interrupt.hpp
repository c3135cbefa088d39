#pragma once

#include <atomic>

namespace aloft::cli {

/// From now on Ctrl-C and SIGTERM do not end this process; the result says whether one has come.
const std::atomic<bool>& note_interrupts();

}  // namespace aloft::cli
