#include "tools/aloft/in_process.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <future>
#include <mutex>
#include <optional>
#include <thread>
#include <utility>

#include "common/base/error.hpp"
#include "common/base/permutation.hpp"
#include "common/experiment/trial_world.hpp"
#include "common/flight/relay.hpp"

namespace aloft::cli {
namespace {

using namespace std::chrono_literals;

constexpr auto look_period = 500ms;       // of checks that the result folder is in place
constexpr auto full_retry_time = 1000ms;  // between attempts to store on a full disk
constexpr auto interrupt_period = 50ms;

struct Flown {
  experiment::FlightKey key;
  std::string trace;
  std::string memory;  ///< for the next flight of the lineage; empty if the agent keeps none
};

/// The trials of an experiment, handed out to the threads that fly them: one by one if they are independent, else
/// lineage by lineage.
class Run {
 public:
  Run(store::ResultStore& results, bool shuffled, unsigned fail_fast, Progress& progress,
      const std::atomic<bool>& interrupted)
      : results_(results),
        experiment_(results.experiment()),
        stored_(results.keys()),
        lineages_(lineages_of(experiment_)),
        order_(shuffled ? shuffled_order() : std::vector<std::uint32_t>{}),
        fail_fast_(fail_fast),
        progress_(progress),
        interrupted_(interrupted),
        done_(stored_.size()) {}

  std::vector<std::string> fly_all(unsigned threads) {
    std::vector<std::future<void>> pool;
    threads_ = threads;
    for (unsigned i = 0; i < threads; ++i) pool.push_back(std::async(std::launch::async, [this] { fly_trials(); }));
    for (std::future<void>& thread : pool) {
      while (thread.wait_for(look_period) != std::future_status::ready) look_at_folder();
      thread.get();
    }
    if (gone_) throw store::ResultsGone(*gone_);
    return std::move(failures_);
  }

 private:
  /// Independent trials are lineages of one trial.
  static std::uint32_t lineages_of(const experiment::Experiment& experiment) {
    const std::uint32_t lineages = experiment::trial_lineages(experiment);
    return lineages == 0 ? experiment.trials : std::min(lineages, experiment.trials);
  }

  [[nodiscard]] std::uint32_t all_lineages() const {
    return lineages_ * static_cast<std::uint32_t>(experiment_.conditions.size());
  }

  [[nodiscard]] std::vector<std::uint32_t> shuffled_order() const {
    RandomStream random(experiment_.seed, 0, "trial-order");
    return permutation(all_lineages(), random);
  }

  void fly_trials() {
    while (!stop()) {
      const std::uint64_t next = next_lineage_++;
      if (next >= all_lineages()) return;
      const std::uint32_t lineage = order_.empty() ? static_cast<std::uint32_t>(next) : order_[next];
      fly_lineage(experiment_.conditions[lineage / lineages_], lineage % lineages_);
    }
  }

  void fly_lineage(const experiment::Condition& condition, std::uint32_t first_trial) {
    for (std::uint32_t trial = first_trial; trial < experiment_.trials && !stop(); trial += lineages_) {
      if (fly_trial(condition, trial)) continue;
      if (experiment_.trials - trial > lineages_)
        fail(fmt::format("condition {} ({}): the trials that follow trial {} in its lineage were not flown",
                         condition.index, condition.name, trial));
      return;
    }
  }

  /// False if a flight failed or could not be stored.
  bool fly_trial(const experiment::Condition& condition, std::uint32_t trial) {
    std::vector<Flown> flown;
    const bool all_flown = succeeds(condition, trial, [&] { fly_missing(condition, trial, flown); });
    const bool stored = succeeds(condition, trial, [&] { store_all(flown); });
    if (!stored) failed_ = true;  // further flights could not be stored either
    return all_flown && stored;
  }

  template <typename Work>
  bool succeeds(const experiment::Condition& condition, std::uint32_t trial, Work work) {
    try {
      work();
      return true;
    } catch (const store::ResultsGone& error) {
      give_up(error);
      return false;
    } catch (const std::exception& error) {
      fail(fmt::format("condition {} ({}), trial {}: {}", condition.index, condition.name, trial, error.what()));
      return false;
    }
  }

  /// The flights of a trial that are not stored yet, appended to `flown`.
  void fly_missing(const experiment::Condition& condition, std::uint32_t trial, std::vector<Flown>& flown) {
    std::unique_ptr<radio::SignalMap> map;
    for (const agents::AgentSpec& spec : experiment_.agents) {
      experiment::FlightKey key{condition.index, trial, spec.name};
      if (stored_.contains(key)) continue;
      if (stop()) return;
      if (!map) map = experiment::make_signal_map(experiment_, condition, trial);
      if (!spec.crew.empty()) {
        const flight::FlightRecord record =
            flight::fly_relay(*map, experiment_.seed, trial, spec, experiment_.costs_in(condition));
        flown.push_back({std::move(key), store::encode_trace(record), {}});
        continue;
      }
      const auto agent = spec.make();
      if (const auto earlier = spec.remembered_trial(trial))
        agent->restore_state(memory_after({condition.index, *earlier, spec.name}));
      const flight::FlightRecord record =
          flight::fly(*map, experiment_.seed, trial, *agent, spec, experiment_.costs_in(condition));
      flown.push_back(
          {std::move(key), store::encode_trace(record), spec.lineages() > 0 ? agent->save_state() : std::string()});
    }
  }

  [[nodiscard]] std::string memory_after(const experiment::FlightKey& key) {
    const std::scoped_lock lock(mutex_);
    std::optional<std::string> memory = results_.memory(key);
    if (!memory) throw IntegrityError("what agent '{}' learnt in trial {} is lost", key.agent, key.trial);
    return std::move(*memory);
  }

  /// Waits for space if the disk is full.
  void store_all(const std::vector<Flown>& flown) {
    bool waits = false;
    do {
      try {
        const std::scoped_lock lock(mutex_);
        if (std::exchange(waits, false)) waiting_ -= flown.size();
        results_.batch([&] {
          for (const Flown& flight : flown) results_.add(flight.key, flight.trace, flight.memory);
        });
        done_ += flown.size();
        progress_.update(done_, threads_, threads_, "");
        return;
      } catch (const store::StoreFull& error) {
        const std::scoped_lock lock(mutex_);
        waits = true;
        waiting_ += flown.size();
        progress_.update(done_, threads_, threads_,
                         fmt::format("{} flights wait, nothing can be stored: {}; trying again every second", waiting_,
                                     error.what()));
      }
      for (auto waited = 0ms; waited < full_retry_time && !stop(); waited += interrupt_period)
        std::this_thread::sleep_for(interrupt_period);
    } while (!stop());
  }

  void look_at_folder() {
    try {
      results_.check_in_place();
    } catch (const store::ResultsGone& error) {
      give_up(error);
    }
  }

  void give_up(const store::ResultsGone& error) {
    const std::scoped_lock lock(mutex_);
    failed_ = true;
    if (!gone_) progress_.note("the results are no longer in place: stops when the flights in the air have ended");
    gone_ = error.what();
  }

  void fail(std::string line) {
    const std::scoped_lock lock(mutex_);
    failures_.push_back(std::move(line));
    if (fail_fast_ > 0 && failures_.size() >= fail_fast_) failed_ = true;
  }

  [[nodiscard]] bool stop() const { return interrupted_ || failed_; }

  store::ResultStore& results_;
  const experiment::Experiment& experiment_;
  const std::set<experiment::FlightKey> stored_;
  const std::uint32_t lineages_;            // of each condition
  const std::vector<std::uint32_t> order_;  // of all lineages; empty: ascending
  unsigned fail_fast_;
  Progress& progress_;
  const std::atomic<bool>& interrupted_;
  unsigned threads_ = 0;
  std::atomic<std::uint64_t> next_lineage_ = 0;
  std::atomic<bool> failed_ = false;
  std::mutex mutex_;
  std::uint64_t done_;
  std::uint64_t waiting_ = 0;  // flights that wait for space on the disk
  std::vector<std::string> failures_;
  std::optional<std::string> gone_;
};

}  // namespace

void check_flies_in_process(const experiment::Experiment& experiment) {
  const auto check = [](const agents::AgentSpec& spec) {
    if (agents::agent_type(spec.type).foreign)
      throw InputError(
          "--in-process: agent '{}' is a program of your own, which speaks over DDS; leave --in-process out "
          "and start your program, or name other agents with --agents",
          spec.name);
  };
  for (const agents::AgentSpec& spec : experiment.agents) {
    check(spec);
    for (const agents::CrewMember& member : spec.crew) check(member.agent);
  }
}

std::vector<std::string> run_in_process(store::ResultStore& results, unsigned threads, bool shuffled,
                                        unsigned fail_fast, Progress& progress, const std::atomic<bool>& interrupted) {
  return Run(results, shuffled, fail_fast, progress, interrupted).fly_all(threads);
}

}  // namespace aloft::cli
