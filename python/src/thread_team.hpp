#pragma once

#include <sys/types.h>

#include <atomic>
#include <condition_variable>
#include <cstddef>
#include <deque>
#include <exception>
#include <functional>
#include <memory>
#include <mutex>
#include <stop_token>
#include <thread>
#include <vector>

namespace aloft::python {

/// Threads that do the parts of one job together with their caller. They start with the first job, and again in a child
/// process: fork() copies no threads.
class ThreadTeam {
 public:
  /// `threads` >= 1, the caller's included.
  explicit ThreadTeam(unsigned threads) : threads_(threads) {}
  ~ThreadTeam();
  ThreadTeam(const ThreadTeam&) = delete;
  ThreadTeam& operator=(const ThreadTeam&) = delete;

  /// Calls part(0) ... part(count - 1), in any order, in several threads. All parts are done, whatever some throw; the
  /// exception of one of them is thrown again. One job at a time.
  void run(std::size_t count, const std::function<void(std::size_t)>& part);

 private:
  /// The parts that a thread begins with, because it did them in the job before and they may be in its cache. Who has
  /// done its own helps others.
  struct alignas(64) Range {
    std::atomic<std::size_t> next = 0;
    std::size_t end = 0;
  };
  /// What threads share; left alone in a child process, where its locks may be held by threads that are not there.
  struct Shared {
    std::mutex mutex;
    std::condition_variable_any begun;
    std::condition_variable ended;
    std::atomic<std::size_t> jobs = 0;     // how many have begun
    std::atomic<std::size_t> working = 0;  // threads that have not ended the present one
    const std::function<void(std::size_t)>* part = nullptr;
    std::size_t portion = 1;
    std::deque<Range> ranges;  // one per thread, the caller's first
    std::exception_ptr failure;
    std::vector<std::jthread> members;
  };

  static void work(const std::stop_token& stop, Shared& shared, std::size_t own);
  static void do_parts(Shared& shared, std::size_t own);
  static void do_portion(Shared& shared, std::size_t begin, std::size_t end);
  void start();

  unsigned threads_;
  pid_t process_ = 0;
  std::unique_ptr<Shared> shared_;
};

}  // namespace aloft::python
