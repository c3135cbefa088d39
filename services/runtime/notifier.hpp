#pragma once

#include <chrono>
#include <string>

namespace aloft::runtime {

/// Reports the state of this process to the service manager (sd_notify(3)): ready, alive, stopping. Does nothing unless
/// the manager asked for it with $NOTIFY_SOCKET, and $WATCHDOG_USEC for alive().
class Notifier {
 public:
  /// `is_child`: the process that started this one reports to the manager; this one does not.
  explicit Notifier(bool is_child = false);
  /// Reports that the process is stopping.
  ~Notifier();
  Notifier(const Notifier&) = delete;
  Notifier& operator=(const Notifier&) = delete;

  /// `status` is one line for people.
  void ready(const std::string& status);
  /// To be called in every round of the main loop, at least every second; sends no more than the manager needs.
  void alive();

 private:
  void send(const std::string& message) const;

  using Clock = std::chrono::steady_clock;
  bool is_child_;
  Clock::duration watchdog_period_{};  // zero: none
  Clock::time_point told_;
};

}  // namespace aloft::runtime
