#include "tools/aloft/in_process.hpp"

#include <fmt/format.h>

#include <mutex>
#include <thread>

#include "common/experiment/trial_world.hpp"

namespace aloft::cli {
namespace {

/// The trials of an experiment, handed out one after another to the threads that fly them.
class Run {
 public:
  Run(store::ResultStore& results, unsigned fail_fast, Progress& progress, const std::atomic<bool>& interrupted)
      : results_(results),
        experiment_(results.experiment()),
        stored_(results.keys()),
        fail_fast_(fail_fast),
        progress_(progress),
        interrupted_(interrupted),
        done_(stored_.size()) {}

  InProcessOutcome fly_all(unsigned threads) {
    {
      std::vector<std::jthread> pool;
      threads_ = threads;
      for (unsigned i = 0; i < threads; ++i) pool.emplace_back([this] { fly_trials(); });
    }
    outcome_.interrupted = interrupted_;
    return std::move(outcome_);
  }

 private:
  void fly_trials() {
    const std::uint64_t trials = std::uint64_t{experiment_.trials} * experiment_.conditions.size();
    while (!stop()) {
      const std::uint64_t next = next_trial_++;
      if (next >= trials) return;
      const auto& condition = experiment_.conditions[next / experiment_.trials];
      fly_trial(condition, static_cast<std::uint32_t>(next % experiment_.trials));
    }
  }

  void fly_trial(const experiment::Condition& condition, std::uint32_t trial) {
    std::unique_ptr<radio::SignalMap> map;
    std::vector<std::pair<experiment::FlightKey, std::string>> flown;
    try {
      for (const agents::AgentSpec& spec : experiment_.agents) {
        experiment::FlightKey key{condition.index, trial, spec.name};
        if (stored_.contains(key)) continue;
        if (stop()) break;
        if (!map) map = experiment::make_signal_map(experiment_, condition, trial);
        const auto agent = spec.make();
        const flight::FlightRecord record = flight::fly(*map, experiment_.seed, trial, *agent, spec);
        flown.emplace_back(std::move(key), store::encode_trace(record));
      }
    } catch (const std::exception& error) {
      fail(fmt::format("condition {} ({}), trial {}: {}", condition.index, condition.name, trial, error.what()));
    }
    store_all(flown);
  }

  void store_all(const std::vector<std::pair<experiment::FlightKey, std::string>>& flown) {
    const std::scoped_lock lock(mutex_);
    results_.batch([&] {
      for (const auto& [key, trace] : flown) results_.add(key, trace);
    });
    done_ += flown.size();
    progress_.update(done_, threads_, threads_, "");
  }

  void fail(std::string line) {
    const std::scoped_lock lock(mutex_);
    outcome_.failures.push_back(std::move(line));
    if (fail_fast_ > 0 && outcome_.failures.size() >= fail_fast_) failed_ = true;
  }

  [[nodiscard]] bool stop() const { return interrupted_ || failed_; }

  store::ResultStore& results_;
  const experiment::Experiment& experiment_;
  const std::set<experiment::FlightKey> stored_;
  unsigned fail_fast_;
  Progress& progress_;
  const std::atomic<bool>& interrupted_;
  unsigned threads_ = 0;
  std::atomic<std::uint64_t> next_trial_ = 0;
  std::atomic<bool> failed_ = false;
  std::mutex mutex_;
  std::uint64_t done_;
  InProcessOutcome outcome_;
};

}  // namespace

InProcessOutcome run_in_process(store::ResultStore& results, unsigned threads, unsigned fail_fast, Progress& progress,
                                const std::atomic<bool>& interrupted) {
  return Run(results, fail_fast, progress, interrupted).fly_all(threads);
}

}  // namespace aloft::cli
