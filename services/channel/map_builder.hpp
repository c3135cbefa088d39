#pragma once

#include <condition_variable>
#include <cstdint>
#include <deque>
#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "common/bus/wire.hpp"
#include "common/experiment/experiment.hpp"
#include "common/radio/signal_map.hpp"

namespace aloft::channel {

/// Turns worlds into signal maps in a thread of its own, so that flights in the air do not wait for the radio of the
/// next trial.
class MapBuilder {
 public:
  struct Built {
    std::uint64_t lease_id = 0;
    std::unique_ptr<radio::SignalMap> map;  ///< null if it failed
    std::string error;
  };

  /// `on_built` is called in the thread, after a result can be taken.
  explicit MapBuilder(std::function<void()> on_built);
  ~MapBuilder();
  MapBuilder(const MapBuilder&) = delete;
  MapBuilder& operator=(const MapBuilder&) = delete;

  void submit(std::shared_ptr<const experiment::Experiment> experiment, const wire::World& world);
  /// Everything that was built since the last call.
  [[nodiscard]] std::vector<Built> take();

 private:
  struct Job {
    std::shared_ptr<const experiment::Experiment> experiment;
    wire::World world;
  };
  void work();

  std::function<void()> on_built_;
  std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<Job> jobs_;
  std::vector<Built> built_;
  bool ending_ = false;
  std::thread thread_;
};

}  // namespace aloft::channel
