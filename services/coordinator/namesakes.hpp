#pragma once

#include <chrono>
#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace aloft::coordinator {

/// Workers that have the same name. They work in one partition, so each of them takes what is meant for the other: none
/// of them may fly until the others are gone. A worker that was restarted is no namesake: the process that it replaces
/// is not heard again. No bus; the clock is passed in.
class Namesakes {
 public:
  using Clock = std::chrono::steady_clock;
  /// Whoever is silent for this long is gone.
  static constexpr std::chrono::seconds silence{3};

  struct Voice {
    std::uint64_t incarnation = 0;
    std::string host;
    std::uint32_t pid = 0;
    Clock::time_point heard;
  };
  enum class Verdict : std::uint8_t {
    alone,      ///< as it should be
    doubled,    ///< since this moment several speak under this name
    held_back,  ///< they still do
    other_left  ///< this one leaves, and another one of its name stays
  };

  Verdict hear(std::string_view worker, const Voice& voice, bool leaves);
  /// "2 workers are called w0: on host alpha (process 12) and on host beta (process 34); ...", of the first such name;
  /// empty if there is none.
  [[nodiscard]] std::string text(Clock::time_point now) const;

 private:
  struct Name {
    std::vector<Voice> voices;  // those that were heard lately
    std::uint64_t last = 0;     // incarnation that spoke last
    bool doubled = false;
  };
  std::map<std::string, Name, std::less<>> names_;
};

}  // namespace aloft::coordinator
