#pragma once

#include <chrono>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "common/base/limits.hpp"
#include "common/base/process_name.hpp"

namespace aloft::coordinator {

/// Which collector is the run's own: whoever has signed the database in the coordinator's result folder. Where there is
/// none to be read, because the collector works on another host, it is the first that is heard, and then whoever goes
/// on with its folder. All others are refused. No bus, no files; the clock is passed in.
class OwnCollector {
 public:
  using Clock = std::chrono::steady_clock;
  static constexpr std::size_t refusals_kept = limits::refused_collectors;
  /// Nobody is refused earlier: until then, the coordinator may itself be the one too many.
  static constexpr std::chrono::seconds settling_time{2};

  /// What a collector says about itself.
  struct News {
    ProcessName process;
    std::string results;  ///< its folder
    std::uint64_t flights_stored = 0;
  };
  /// What the coordinator sees in its own folder.
  struct Folder {
    bool has_database = false;
    std::optional<ProcessName> signer;
  };
  enum class Verdict : std::uint8_t {
    own,          ///< as before
    now_own,      ///< since this moment
    foreign,      ///< not to be listened to
    now_refused,  ///< the same, and it has to be told
  };

  OwnCollector(std::string host, Clock::time_point now) : host_(std::move(host)), start_(now) {}

  [[nodiscard]] bool is_own(const ProcessName& process) const noexcept {
    return own_ && own_->process.incarnation == process.incarnation;
  }
  /// `folder` is looked at only if the collector is not known to be the run's own.
  Verdict hear(const News& news, const Folder& folder, Clock::time_point now);

  /// None until it is known.
  [[nodiscard]] const std::optional<News>& own() const noexcept { return own_; }
  /// Incarnations, the oldest first.
  [[nodiscard]] const std::vector<std::uint64_t>& refused() const noexcept { return refused_; }

 private:
  [[nodiscard]] bool becomes_own(const News& news, const Folder& folder) const;

  std::string host_;
  Clock::time_point start_;
  std::optional<News> own_;
  std::vector<std::uint64_t> refused_;
};

}  // namespace aloft::coordinator
