#pragma once

#include <string_view>

namespace aloft {

/// Which build made a result: version, commit (with "-dirty" if files were changed), compiler, build type; e.g.
/// "0.2.0+4f59d1e25c5e GNU-12.2.0 Release".
[[nodiscard]] std::string_view build_id() noexcept;

}  // namespace aloft
