#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace aloft {

/// A process, so that people find it, and nobody takes its successor for it.
struct ProcessName {
  std::uint64_t incarnation = 0;  ///< random, of this start alone; 0: nobody
  std::string host;               ///< at most 64 bytes
  std::uint32_t pid = 0;
  std::uint64_t since_s = 0;  ///< Unix time of its start

  [[nodiscard]] bool known() const noexcept { return incarnation != 0; }
};

/// The largest ProcessName::since_s that is a date: the end of the year 9999.
inline constexpr std::uint64_t latest_since_s = 253'402'300'799;

/// The same for the whole life of this process.
[[nodiscard]] const ProcessName& this_process();

/// "aloft-metrics on host alpha (process 5217, since 2026-11-22 13:45:10)"
[[nodiscard]] std::string to_text(const ProcessName& process, std::string_view program);

}  // namespace aloft
