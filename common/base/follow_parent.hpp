#pragma once

namespace aloft {

/// From now on this process is asked to end (SIGTERM) when the process that started it ends, in any way.
void follow_parent();

}  // namespace aloft
