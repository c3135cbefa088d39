#pragma once

#include <map>
#include <memory>
#include <mutex>
#include <string>

#include "services/http/http_server.hpp"
#include "services/runtime/run_follower.hpp"
#include "services/status/run_observer.hpp"

namespace aloft::live {

/// A run on the bus, for the page. Thread-safe: one thread listens, the server asks.
class RunWatch {
 public:
  explicit RunWatch(const bus::BusOptions& place) : observer_(place), follower_(observer_.participant()) {}

  /// Takes what has arrived; to be called several times a second.
  void listen();
  /// Null until the run has told it.
  [[nodiscard]] std::shared_ptr<const experiment::Experiment> experiment() const;
  /// Events with status::RunView::to_json(). The watch must outlive their server.
  [[nodiscard]] std::map<std::string, http::HttpRoute> routes() const;

 private:
  mutable std::mutex mutex_;
  status::RunObserver observer_;
  runtime::RunFollower follower_;
};

}  // namespace aloft::live
