#pragma once

#include <chrono>
#include <memory>

#include "common/base/stop_signal.hpp"
#include "common/bus/endpoint.hpp"

namespace aloft::bus {

/// Lets one application thread sleep until a reader has data, someone calls wake(), or a stop is asked for.
/// Readers that were added must outlive it or be destroyed without another wait().
class Waiter {
 public:
  Waiter();
  explicit Waiter(StopSignal& stop);
  ~Waiter();
  Waiter(const Waiter&) = delete;
  Waiter& operator=(const Waiter&) = delete;

  template <class T>
  void add(Reader<T>& reader) {
    attach(reader.condition());
  }

  /// False if the time ran out.
  bool wait(std::chrono::milliseconds limit);
  /// Ends the present or the next wait; from any thread.
  void wake();

 private:
  void attach(void* condition);

  struct State;
  std::unique_ptr<State> state_;
  StopSignal::Ticket ticket_;  // the last member: cancelled before the state is destroyed
};

}  // namespace aloft::bus
