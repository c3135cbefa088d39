#pragma once

#include <chrono>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "common/base/random.hpp"
#include "common/radio/reading.hpp"
#include "common/radio/serving_rule.hpp"

namespace aloft::flight {

/// What happened to the connection in one step, where networks hand the UAV over.
struct MobilityEvents {
  std::uint32_t handovers = 0;  ///< that succeeded
  std::uint32_t ping_pongs = 0;
  std::uint32_t radio_link_failures = 0;  ///< with handovers that failed
  double outage_s = 0.0;                  ///< without a cell, or with an SINR below the threshold of outage

  bool operator==(const MobilityEvents&) const = default;
};

/// Which cell serves a UAV as time passes: handover by event A3 of TS 36.331, and radio link failures as TR 36.839 has
/// them. In a step the UAV moves to the step's place: received powers change evenly, in dB, from those of the place
/// before; SINR and quality are those of the step's place. Filters and timers run on from step to step. A pure function
/// of seed, trial and places. Time is counted in whole microseconds.
///
/// Layer 1 measures the received powers of all cells at the beginning of the flight and once per window, with a normal
/// error, and layer 3 filters them. A neighbour that is stronger than the serving cell by the offset, and at no later
/// measurement weaker than that, triggers a handover after the time to trigger. It is prepared while the old cell
/// serves, and executed while none does; meanwhile nothing else triggers. It fails if the SINR is below Qout: that of
/// the old cell when the command is due, or of the new one at the end. A link also fails if its SINR falls below Qout
/// and does not reach Qin for T310. The UAV then goes to the cell with the strongest filtered power. At an instant
/// timers come before a measurement, and both before the next step.
class Mobility {
 public:
  /// `step_s`: how long a step takes.
  Mobility(const radio::A3Rules& rules, std::uint64_t seed, std::uint32_t trial, double step_s,
           double outage_threshold_db);

  /// The cell that serves or, while none does, that the UAV is going to; -1 before begin().
  [[nodiscard]] std::int32_t serving() const noexcept { return serving_; }
  /// The cells that those of the next step must have among them.
  [[nodiscard]] std::span<const std::int32_t> followed() const noexcept { return followed_; }

  /// Before the first step: the cell with the strongest power serves.
  void begin(std::span<const radio::CellReading> cells);

  struct Passage {
    double qos = 0.0;  ///< mean over the step; 0 while no cell serves
    MobilityEvents events{};
  };
  /// One step, to a place with these cells.
  [[nodiscard]] Passage pass(std::span<const radio::CellReading> cells);

 private:
  using Time = std::chrono::microseconds;

  enum class State : std::uint8_t { connected, preparing, executing, reestablishing };

  /// A cell as the UAV hears it.
  struct Heard {
    std::int32_t cell = -1;
    double before_dbm = 0.0;               ///< at the place before
    std::optional<double> filtered_dbm{};  ///< nothing before its first measurement
    std::optional<Time> stronger_since{};  ///< than the serving cell by the offset
  };

  void hear();
  [[nodiscard]] const radio::CellReading& here(std::int32_t cell) const;
  [[nodiscard]] bool serves() const noexcept { return state_ == State::connected || state_ == State::preparing; }
  [[nodiscard]] Time next_timer() const;

  void spend(Time until);
  void settle();
  void run_timer();
  void measure();
  [[nodiscard]] double measured_dbm(const Heard& heard) const;
  void compare_neighbours();
  void watch_link();
  void prepare();
  void execute();
  void complete();
  void fail();
  void connect(std::int32_t former);
  void enter(State state, Time duration);

  radio::A3Rules rules_;
  double outage_threshold_db_;
  double weight_of_new_;
  Time step_;
  RandomStream errors_;

  Time now_{0};
  Time next_measurement_{0};
  std::uint32_t measurements_ = 0;
  State state_ = State::connected;
  Time state_ends_{0};  // unless connected
  std::optional<Time> link_fails_;
  std::int32_t serving_ = -1;
  std::int32_t other_ = -1;   // of a handover: the new cell while it is prepared, then the old one
  std::int32_t former_ = -1;  // that the serving cell was handed over from; -1: from none
  Time connected_since_{0};
  std::vector<Heard> heard_;  // the cells of the present place
  std::vector<std::int32_t> followed_;

  // Of the present step:
  std::span<const radio::CellReading> cells_;
  Time step_began_{0};
  Time served_{0};  // by the serving cell, and not yet in passage_
  Time out_{0};
  Passage passage_;
};

}  // namespace aloft::flight
