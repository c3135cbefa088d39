#pragma once

#include <chrono>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "common/agents/registry.hpp"

namespace aloft::channel {

using Clock = std::chrono::steady_clock;

/// A standing order: from `from_step` of a flight on (0: at once), this agent flies.
struct SwapOrder {
  std::string agent;
  std::uint32_t from_step = 0;
};

/// Which member of a relay's crew flies, which ones follow, and which ones the flight waits for. No bus; the clock is
/// passed in.
///
/// With `failover` the flight depends on no single member: if the pilot is silent, a member that stands by takes over
/// with its command (which the middleware delivers only when the pilot's process is gone), a silent follower is left
/// behind, and a member that is absent from the start is neither asked nor waited for. Without `failover`, the crew's
/// entries alone decide which member flies, and a lost member makes the flight start again.
class Crew {
 public:
  /// `relay` must outlive the crew.
  Crew(const agents::AgentSpec& relay, bool failover, Clock::time_point now);

  [[nodiscard]] const agents::AgentSpec& pilot() const noexcept { return agent(pilot_); }
  [[nodiscard]] bool failover() const noexcept { return failover_; }

  /// These members are not there when the flight begins: others are asked in their place. True if the pilot changes.
  bool do_without(const std::vector<std::string>& absent, Clock::time_point now);
  /// An absent member has arrived: it can be asked, and is waited for after its first message.
  void comes(std::string_view name);
  /// Chooses the pilot of `step`, after the report of `step` - 1. True if the pilot changes.
  bool begin_step(std::uint32_t step, Clock::time_point now);
  /// From now on, or from a later step on, this agent of the crew flies; true if the pilot changes at once.
  bool order(const SwapOrder& order, std::uint32_t step, Clock::time_point now);
  /// True until a command of the ordered agent is executed.
  [[nodiscard]] bool order_open() const noexcept { return order_open_; }

  /// Makes this agent the pilot if it may command now; true if it is.
  [[nodiscard]] bool admit(std::string_view name, Clock::time_point now);
  /// The pilot cannot go on; true if another one was found.
  [[nodiscard]] bool pass_on(Clock::time_point now);
  /// The pilot's command has been executed.
  void executed() noexcept;

  /// This agent has learnt from the present report.
  void followed(std::string_view name);
  /// Whether all members that are waited for have learnt from the present report.
  [[nodiscard]] bool all_followed() const;
  /// With failover, stops waiting for members that have not followed the present report within a second.
  void leave_behind(Clock::time_point now);
  /// Followers that have still to learn from the present report.
  [[nodiscard]] std::vector<std::string_view> behind() const;

 private:
  struct Member {
    bool aboard = false;
    bool absent = false;    // not asked and not waited for, until it arrives or sends a message
    bool left = false;      // not waited for, until its next message
    bool followed = false;  // the present report
    bool failed = false;    // could not command this step
  };
  [[nodiscard]] const agents::AgentSpec& agent(std::size_t index) const noexcept { return relay_.crew[index].agent; }
  [[nodiscard]] std::size_t find(std::string_view name) const noexcept;
  [[nodiscard]] bool is_behind(std::size_t index) const noexcept;
  /// The member to ask for `step`; an order takes effect here.
  std::size_t appoint(std::uint32_t step);
  /// The member to ask when it is this one's turn: another one if this one is absent.
  [[nodiscard]] std::size_t present(std::size_t index) const noexcept;
  /// Whether the member is aboard and can be asked.
  [[nodiscard]] bool at_hand(std::size_t index) const noexcept;
  /// True if the pilot changes.
  bool ask(std::size_t index, Clock::time_point now);

  const agents::AgentSpec& relay_;
  bool failover_;
  std::vector<Member> members_;
  std::size_t pilot_ = 0;
  std::optional<SwapOrder> order_;  // overrules the crew's entries from its step on
  bool order_in_effect_ = false;
  bool order_open_ = false;
  Clock::time_point asked_at_;  // the present pilot, for the present step
};

}  // namespace aloft::channel
