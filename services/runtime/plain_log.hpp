#pragma once

#include <spdlog/formatter.h>

#include <memory>
#include <string>

namespace aloft::runtime {

/// Lines in spdlog's pattern, where the message %v is plain text (base/plain_text.hpp): whatever names and messages
/// from the wire contain, an entry of the log is one line without control sequences for a terminal.
[[nodiscard]] std::unique_ptr<spdlog::formatter> plain_log(const std::string& pattern);

}  // namespace aloft::runtime
