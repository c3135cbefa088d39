#pragma once

#include <atomic>
#include <cstddef>
#include <exception>
#include <functional>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

namespace aloft::train {

/// Thrown when training is asked to stop.
struct Interrupted : std::exception {};

/// Shows the progress of training and stops it. Called from several threads, one at a time.
struct Watch {
  std::function<void(const std::string& phase, double share)> progress{};  ///< share of the phase that is done
  std::function<bool()> stop{};

  /// Reports the progress; Interrupted if training is to stop.
  void tell(const std::string& phase, double share) const {
    if (stop && stop()) throw Interrupted();
    if (progress) progress(phase, share);
  }
};

/// Calls work(thread, item) for items 0 to count - 1, each once, on `threads` threads. Throws what the work throws.
inline void for_each_item(std::size_t count, unsigned threads, const std::function<void(unsigned, std::size_t)>& work) {
  std::atomic<std::size_t> next = 0;
  std::exception_ptr failure;
  std::mutex failure_mutex;
  const auto run = [&](unsigned thread) {
    try {
      for (std::size_t item = next++; item < count; item = next++) work(thread, item);
    } catch (...) {
      next = count;
      const std::lock_guard lock(failure_mutex);
      failure = std::current_exception();
    }
  };
  {
    std::vector<std::jthread> helpers;
    for (unsigned thread = 1; thread < threads; ++thread) helpers.emplace_back(run, thread);
    run(0);
  }
  if (failure) std::rethrow_exception(failure);
}

/// The same, reported as one phase.
inline void for_each_item(std::size_t count, unsigned threads, const Watch& watch, const std::string& phase,
                          const std::function<void(unsigned, std::size_t)>& work) {
  std::mutex mutex;
  std::size_t done = 0;
  for_each_item(count, threads, [&](unsigned thread, std::size_t item) {
    work(thread, item);
    const std::lock_guard lock(mutex);
    watch.tell(phase, static_cast<double>(++done) / static_cast<double>(count));
  });
}

}  // namespace aloft::train
