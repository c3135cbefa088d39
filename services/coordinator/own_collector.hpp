#pragma once

#include <chrono>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "common/base/limits.hpp"
#include "common/base/process_name.hpp"

namespace aloft::coordinator {

/// Which collector is the run's own: the one that has signed the database in the coordinator's result folder. If there
/// is no database to read, because the collector works on another host, it is the first collector that reports, and
/// later one that continues its folder. All others are refused. No bus, no files; the clock is passed in.
class OwnCollector {
 public:
  using Clock = std::chrono::steady_clock;
  static constexpr std::size_t refusals_kept = limits::refused_collectors;
  /// No collector is refused earlier: until then, this coordinator may itself be the second one of the run.
  static constexpr std::chrono::seconds settling_time{2};

  /// What a collector reports about itself.
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
    now_own,      ///< from now on
    foreign,      ///< another collector, to be ignored
    now_refused,  ///< another collector, which has to be told that it is refused
  };

  OwnCollector(std::string host, Clock::time_point now) : host_(std::move(host)), start_(now) {}

  [[nodiscard]] bool is_own(const ProcessName& process) const noexcept {
    return own_ && own_->process.incarnation == process.incarnation;
  }
  /// `folder` is used only if the collector is not known to be the run's own.
  Verdict hear(const News& news, const Folder& folder, Clock::time_point now);

  /// None until the run's own collector is known.
  [[nodiscard]] const std::optional<News>& own() const noexcept { return own_; }
  /// Incarnations of refused collectors, oldest first.
  [[nodiscard]] const std::vector<std::uint64_t>& refused() const noexcept { return refused_; }

 private:
  [[nodiscard]] bool becomes_own(const News& news, const Folder& folder) const;

  std::string host_;
  Clock::time_point start_;
  std::optional<News> own_;
  std::vector<std::uint64_t> refused_;
};

}  // namespace aloft::coordinator
