#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "python/src/environment.hpp"
#include "python/src/thread_team.hpp"

namespace aloft::python {

/// When an environment whose flight has ended begins the next one.
enum class Autoreset : std::uint8_t { disabled, next_step, same_step };

/// What is told beside observations.
enum class Foresight : std::uint8_t { none, next_step, whole_route };

/// Environments that step together. After reset() and step() the columns below tell about all of them; their memory
/// stays in place. Calls from several threads at a time are refused.
class Fleet {
 public:
  struct Settings {
    Layout layout{};
    Foresight foresight = Foresight::none;
    Autoreset autoreset = Autoreset::disabled;
    std::uint32_t environments = 1;
    std::uint32_t threads = 0;  ///< 0: one per usable core
  };

  /// Throws InputError.
  Fleet(std::shared_ptr<const Worlds> worlds, const Settings& settings);

  [[nodiscard]] std::uint32_t size() const noexcept { return settings_.environments; }
  [[nodiscard]] const Layout& layout() const noexcept { return settings_.layout; }

  /// Begins the flights of those environments that `chosen` names; one entry per environment each. Throws InputError.
  void reset(std::span<const Start> starts, std::span<const std::uint8_t> chosen);

  /// Executes one action each: 0 down, 1 hold, 2 up. Before anything moves, throws InputError for other actions, and
  /// std::runtime_error if a flight has not begun, or is at its end and the environment does not begin the next one.
  void step(std::span<const std::int64_t> actions);

  /// Looks at one environment. Throws InputError if there is no such one, std::runtime_error if no flight has begun.
  template <typename Work>
  auto look(std::uint32_t index, Work work) const {
    const Turn turn(busy_);
    return work(environment(index));
  }

  /// Columns of numbers: one value per environment, column after column.
  enum Number : std::uint8_t { reward, height_m, x_m, y_m, qos, energy_j, numbers };
  enum Integer : std::uint8_t { serving_cell, executed, seed, trial, steps, condition, integers };
  enum Flag : std::uint8_t { handover, terminated, stepped, began, foreseen, flags };

  /// Memory that Python sees as arrays.
  struct Columns {
    std::vector<float> observation;        ///< environments x layout.size()
    std::vector<float> final_observation;  ///< likewise, of flights that ended; only with Autoreset::same_step
    std::vector<double> number;
    std::vector<std::int64_t> integer;
    std::vector<std::uint8_t> flag;
    std::vector<double> profile;  ///< environments x heights, or environments x steps x heights; empty: no foresight
    std::uint32_t profile_steps = 0;
    std::uint32_t profile_heights = 0;
  };
  [[nodiscard]] Columns& columns() noexcept { return columns_; }

 private:
  /// Refuses what comes while another thread is in here.
  class Turn {
   public:
    explicit Turn(std::atomic_flag& busy);
    ~Turn() { busy_.clear(std::memory_order_release); }
    Turn(const Turn&) = delete;
    Turn& operator=(const Turn&) = delete;

   private:
    std::atomic_flag& busy_;
  };

  [[nodiscard]] const Environment& environment(std::uint32_t index) const;
  void check_conditions() const;
  void check_action(std::uint32_t index, std::int64_t action) const;
  void begin_one(std::uint32_t index, const Start& start);
  void step_one(std::uint32_t index, std::int64_t action);
  void begin_next(std::uint32_t index);
  void write_start(std::uint32_t index);
  void write_step(std::uint32_t index);
  void write_foresight(std::uint32_t index);
  void write_profile(std::uint32_t index, const agents::HeightProfile& profile, std::uint32_t row);
  [[nodiscard]] std::span<float> observation_of(std::vector<float>& all, std::uint32_t index) const;

  double& at(Number column, std::uint32_t index) { return columns_.number[column * size() + index]; }
  std::int64_t& at(Integer column, std::uint32_t index) { return columns_.integer[column * size() + index]; }
  std::uint8_t& at(Flag column, std::uint32_t index) { return columns_.flag[column * size() + index]; }

  Settings settings_;
  std::shared_ptr<const Worlds> worlds_;
  std::vector<Environment> environments_;
  Columns columns_;
  ThreadTeam team_;
  mutable std::atomic_flag busy_;
};

}  // namespace aloft::python
