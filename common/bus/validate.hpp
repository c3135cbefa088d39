#pragma once

#include "common/bus/wire.hpp"

namespace aloft::bus {

/// The limits of the wire, from topics.def. Checked before every write and after every read; null if the sample is
/// good, else what is wrong with it.
#define ALOFT_TOPIC(type, ...) [[nodiscard]] const char* validate(const wire::type& sample) noexcept;
#include "common/bus/topics.def"

}  // namespace aloft::bus
