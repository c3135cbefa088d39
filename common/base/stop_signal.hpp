#pragma once

#include <atomic>
#include <functional>
#include <list>
#include <memory>
#include <mutex>
#include <thread>

namespace aloft {

/// Turns SIGINT and SIGTERM into a flag and wakes all waiting threads. Create it in main() before any other thread: the
/// signals are blocked there and in every thread started later. A second signal ends the process at once with code 130.
class StopSignal {
 public:
  StopSignal();
  ~StopSignal();
  StopSignal(const StopSignal&) = delete;
  StopSignal& operator=(const StopSignal&) = delete;

  [[nodiscard]] bool requested() const noexcept { return requested_; }
  /// True if the stop was requested by a signal, not by request().
  [[nodiscard]] bool interrupted() const noexcept { return interrupted_; }
  /// Requests a stop from inside the process.
  void request();

  /// `call` runs once in another thread when a stop is requested, immediately if it already was; it must not block.
  /// Destroying the returned ticket cancels the call.
  using Ticket = std::shared_ptr<void>;
  [[nodiscard]] Ticket on_request(std::function<void()> call);

 private:
  struct Calls {
    std::mutex mutex;
    std::list<std::function<void()>> list;
  };

  void watch();

  std::atomic<bool> requested_{false};
  std::atomic<bool> interrupted_{false};
  std::shared_ptr<Calls> calls_ = std::make_shared<Calls>();
  int signal_fd_ = -1;
  int end_fd_ = -1;
  std::thread thread_;
};

}  // namespace aloft
