#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "common/agents/privilege.hpp"
#include "common/experiment/experiment.hpp"
#include "common/experiment/trial_world.hpp"

namespace aloft::python {

/// What the caller sets beside the worlds.
struct Choices {
  std::optional<double> energy_weight{};        ///< unset: the file's, or 0
  std::optional<double> handover_cost{};        ///< likewise
  std::vector<agents::Privilege> privileges{};  ///< what observations and infos tell beside reports
};

/// The worlds in which the environments of one constructor fly: the conditions of an experiment, without its agents.
/// May be used from any thread.
class Worlds {
 public:
  /// `world`: JSON text, as "world" of an experiment file. Relative paths in it count from the working directory.
  /// Throws InputError.
  Worlds(std::string_view world, const Choices& choices);
  /// The worlds of an experiment file, whose agents are ignored. Throws InputError.
  Worlds(const std::filesystem::path& experiment_file, const Choices& choices);

  Worlds(const Worlds&) = delete;
  Worlds& operator=(const Worlds&) = delete;

  [[nodiscard]] const std::vector<experiment::Condition>& conditions() const noexcept { return experiment_.conditions; }
  [[nodiscard]] flight::Costs costs(std::uint32_t condition) const;

  /// The city or the measured flight of a trial. Throws InputError.
  [[nodiscard]] experiment::TrialWorld world(std::uint32_t condition, std::uint64_t seed, std::uint32_t trial) const;
  /// What a UAV can measure there: the same for one (condition, seed, trial) everywhere. Throws InputError.
  [[nodiscard]] std::unique_ptr<radio::SignalMap> map(std::uint32_t condition, std::uint64_t seed,
                                                      std::uint32_t trial) const;
  /// Whether all trials of the condition are the same.
  [[nodiscard]] bool measured(std::uint32_t condition) const;

 private:
  /// A file that is read when it is first flown.
  struct Measured {
    std::mutex mutex;
    std::unique_ptr<const experiment::TrialWorld> world;
  };

  explicit Worlds(experiment::Experiment experiment);
  [[nodiscard]] const experiment::TrialWorld& measured_world(std::uint32_t condition) const;

  experiment::Experiment experiment_;
  std::vector<std::unique_ptr<Measured>> measured_;  // per condition; null: generated
};

}  // namespace aloft::python
