#pragma once

namespace aloft::test {

/// Gives this process its own mounts, which end with it, as root or through a user namespace. Where that is not
/// allowed, the test case is skipped: `if (!own_mounts()) return;`.
[[nodiscard]] bool own_mounts();

}  // namespace aloft::test
