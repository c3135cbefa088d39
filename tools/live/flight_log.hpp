#pragma once

#include <array>
#include <chrono>
#include <cstdint>
#include <map>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>

#include "common/bus/wire.hpp"

namespace aloft::live {

/// The flights over one world, as the reports and commands of a worker tell them: the world that is flown in one
/// stream, and all agents that fly it at the same time. Once it is flown it is shown for a while, then the next one. No
/// bus; the clock is passed in.
class FlightLog {
 public:
  using Clock = std::chrono::steady_clock;
  /// Of each flight the latest steps are kept.
  static constexpr std::size_t kept_steps = 1000;
  /// A world is shown for at least so long.
  static constexpr std::chrono::milliseconds show_time{3000};

  /// `stream`: the one to follow; none: the first that is heard.
  explicit FlightLog(std::optional<std::uint32_t> stream) : stream_(stream) {}

  void hear(const wire::ChannelReport& report, Clock::time_point now);
  void hear(const wire::HeightCommand& command);
  /// False while a world that is flown is shown: what is heard then would not be shown.
  [[nodiscard]] bool wants_more(Clock::time_point now) const;

  /// {"stream": null | followed, "streams": [{"stream", "agent", "condition", "trial"}], "flight": null | {"condition",
  /// "trial", "over", "step": [...], "height_min_m", "height_max_m", "height_step_m", "agents": as report::flight_view
  /// has them, but null where nothing was heard, and with "stream" and "at", the last step}}
  [[nodiscard]] nlohmann::json view(Clock::time_point now) const;

 private:
  struct World {
    std::uint32_t condition = 0;
    std::uint32_t trial = 0;
    auto operator<=>(const World&) const = default;
  };
  struct Seen {
    std::string agent;
    World world;
  };
  struct Learning {
    double epsilon = 0.0;
    double loss = 0.0;
    std::array<double, 3> q_values{};
  };
  struct Step {
    std::optional<wire::ChannelReport> report;
    std::optional<Learning> learning;
  };
  struct Track {
    std::uint32_t stream = 0;
    std::uint64_t episode_id = 0;
    std::uint32_t attempt = 0;
    bool over = false;
    std::map<std::uint32_t, Step> steps;

    /// Null if it is too old to be kept.
    Step* at(std::uint32_t step);
    [[nodiscard]] std::uint32_t last_step() const;
  };

  [[nodiscard]] bool is_next(const wire::ChannelReport& report, Clock::time_point now) const;
  [[nodiscard]] bool over(Clock::time_point now) const;
  void add(const wire::ChannelReport& report);
  [[nodiscard]] nlohmann::json flight(Clock::time_point now) const;

  std::optional<std::uint32_t> stream_;
  std::map<std::uint32_t, Seen> streams_;
  std::optional<World> world_;
  bool whole_ = false;  ///< the flight of the stream was heard from its beginning
  Clock::time_point begun_;
  Clock::time_point heard_;
  wire::ChannelReport facts_;            ///< what is known before the flight
  std::map<std::string, Track> tracks_;  ///< by agent, or relay
};

}  // namespace aloft::live
