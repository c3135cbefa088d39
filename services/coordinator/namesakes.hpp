#pragma once

#include <chrono>
#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace aloft::coordinator {

/// Finds workers that have the same name. They work in one partition, so each of them receives messages that are meant
/// for the other: none of them may fly until the others are gone. A worker that was restarted is no namesake, because
/// the process that it replaces sends nothing any more. No bus; the clock is passed in.
class Namesakes {
 public:
  using Clock = std::chrono::steady_clock;
  /// A worker that is silent for longer is gone.
  static constexpr std::chrono::seconds silence{3};

  struct Voice {
    std::uint64_t incarnation = 0;
    std::string host;
    std::uint32_t pid = 0;
    Clock::time_point heard;
  };
  enum class Verdict : std::uint8_t {
    alone,      ///< one process has this name
    doubled,    ///< from now on, several processes have this name
    held_back,  ///< several processes still have it
    other_left  ///< this process leaves, and another one of its name stays
  };

  Verdict hear(std::string_view worker, const Voice& voice, bool leaves);
  /// "2 workers are called w0: on host alpha (process 12) and on host beta (process 34); ...", of the first such name;
  /// empty if there is none.
  [[nodiscard]] std::string text(Clock::time_point now) const;

 private:
  struct Name {
    std::vector<Voice> voices;  // processes that have reported lately
    std::uint64_t last = 0;     // incarnation that reported last
    bool doubled = false;
  };
  std::map<std::string, Name, std::less<>> names_;
};

}  // namespace aloft::coordinator
