#pragma once

#include <boost/asio/thread_pool.hpp>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "common/bus/wire.hpp"
#include "common/experiment/experiment.hpp"
#include "common/radio/signal_map.hpp"

namespace aloft::channel {

/// Turns worlds into signal maps in a thread of its own, so that flights in the air do not wait for the map of the
/// next trial, and for its columns if an agent is shown them.
class MapBuilder {
 public:
  struct Built {
    std::uint64_t lease_id = 0;
    std::unique_ptr<radio::SignalMap> map;  ///< null if it failed
    std::string error;
  };

  /// `on_built` is called in the thread, after a result can be taken.
  explicit MapBuilder(std::function<void()> on_built);

  void submit(std::shared_ptr<const experiment::Experiment> experiment, const wire::World& world);
  /// Everything that was built since the last call.
  [[nodiscard]] std::vector<Built> take();

 private:
  std::function<void()> on_built_;
  std::mutex mutex_;
  std::vector<Built> built_;
  boost::asio::thread_pool thread_{1};  // last: its jobs use the members above
};

}  // namespace aloft::channel
