#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace aloft {

/// Identifies a process to people, and distinguishes it from a restart of the same program.
struct ProcessName {
  std::uint64_t incarnation = 0;  ///< random, different for each start; 0: no process
  std::string host;               ///< at most 64 bytes
  std::uint32_t pid = 0;
  std::uint64_t since_s = 0;  ///< Unix time of its start

  [[nodiscard]] bool known() const noexcept { return incarnation != 0; }
};

/// The largest ProcessName::since_s that can be printed as a date: the end of the year 9999.
inline constexpr std::uint64_t latest_since_s = 253'402'300'799;

/// The name of this process; it stays the same until the process ends.
[[nodiscard]] const ProcessName& this_process();

/// "aloft-metrics on host alpha (process 5217, since 2026-11-22 13:45:10)"
[[nodiscard]] std::string to_text(const ProcessName& process, std::string_view program);

}  // namespace aloft
