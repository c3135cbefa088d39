#include "python/src/thread_team.hpp"

#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <utility>

namespace aloft::python {

namespace {

constexpr std::size_t portions_per_range = 8;  // so that threads end together, though parts take unequal times

// Waking a thread takes about as long as stepping 64 environments, so threads look for a while before they sleep.
constexpr std::chrono::microseconds look_for{100};

/// True once the condition holds; false if it does not for look_for.
template <typename Condition>
bool soon(Condition condition) {
  const auto end = std::chrono::steady_clock::now() + look_for;
  do {
    for (int i = 0; i < 64; ++i)
      if (condition()) return true;
  } while (std::chrono::steady_clock::now() < end);
  return false;
}

}  // namespace

ThreadTeam::~ThreadTeam() {
  if (shared_ && process_ != ::getpid()) static_cast<void>(shared_.release());  // see Shared
}

void ThreadTeam::start() {
  if (shared_ && process_ == ::getpid()) return;
  static_cast<void>(shared_.release());
  process_ = ::getpid();
  shared_ = std::make_unique<Shared>();
  for (unsigned i = 0; i < threads_; ++i) shared_->ranges.emplace_back();
  for (unsigned i = 1; i < threads_; ++i)
    shared_->members.emplace_back([shared = shared_.get(), i](const std::stop_token& stop) { work(stop, *shared, i); });
}

void ThreadTeam::run(std::size_t count, const std::function<void(std::size_t)>& part) {
  if (threads_ == 1 || count < 2) {
    std::exception_ptr failure;
    for (std::size_t i = 0; i < count; ++i) {
      try {
        part(i);
      } catch (...) {
        if (!failure) failure = std::current_exception();
      }
    }
    if (failure) std::rethrow_exception(failure);
    return;
  }
  start();
  Shared& shared = *shared_;
  {
    const std::scoped_lock lock(shared.mutex);
    shared.part = &part;
    shared.portion = std::max<std::size_t>(1, count / (threads_ * portions_per_range));
    for (std::size_t i = 0; i < threads_; ++i) {
      shared.ranges[i].next = count * i / threads_;
      shared.ranges[i].end = count * (i + 1) / threads_;
    }
    shared.failure = nullptr;
    shared.working = shared.members.size();
    ++shared.jobs;
  }
  shared.begun.notify_all();
  do_parts(shared, 0);
  if (!soon([&shared] { return shared.working == 0; })) {
    std::unique_lock lock(shared.mutex);
    shared.ended.wait(lock, [&shared] { return shared.working == 0; });
  }
  if (shared.failure) std::rethrow_exception(std::exchange(shared.failure, nullptr));
}

void ThreadTeam::work(const std::stop_token& stop, Shared& shared, std::size_t own) {
  std::size_t done = 0;
  while (true) {
    const auto begun = [&shared, done] { return shared.jobs != done; };
    if (!soon(begun)) {
      std::unique_lock lock(shared.mutex);
      if (!shared.begun.wait(lock, stop, begun)) return;
    }
    done = shared.jobs;
    do_parts(shared, own);
    if (--shared.working > 0) continue;
    const std::scoped_lock lock(shared.mutex);  // else the notice could come before the wait for it
    shared.ended.notify_one();
  }
}

void ThreadTeam::do_parts(Shared& shared, std::size_t own) {
  for (std::size_t k = 0; k < shared.ranges.size(); ++k) {
    Range& range = shared.ranges[(own + k) % shared.ranges.size()];
    for (std::size_t begin = 0; (begin = range.next.fetch_add(shared.portion)) < range.end;)
      do_portion(shared, begin, std::min(begin + shared.portion, range.end));
  }
}

void ThreadTeam::do_portion(Shared& shared, std::size_t begin, std::size_t end) {
  for (std::size_t i = begin; i < end; ++i) {
    try {
      (*shared.part)(i);
    } catch (...) {
      const std::scoped_lock lock(shared.mutex);
      if (!shared.failure) shared.failure = std::current_exception();
    }
  }
}

}  // namespace aloft::python
