#include "python/src/thread_team.hpp"

#include <unistd.h>

#include <algorithm>
#include <utility>

namespace aloft::python {

namespace {

constexpr std::size_t portions_per_thread = 8;  // so that threads end together, though parts take unequal times

}  // namespace

ThreadTeam::~ThreadTeam() {
  if (shared_ && process_ != ::getpid()) static_cast<void>(shared_.release());  // see Shared
}

void ThreadTeam::start() {
  if (shared_ && process_ == ::getpid()) return;
  static_cast<void>(shared_.release());
  process_ = ::getpid();
  shared_ = std::make_unique<Shared>();
  for (unsigned i = 1; i < threads_; ++i)
    shared_->members.emplace_back([shared = shared_.get()](const std::stop_token& stop) { work(stop, *shared); });
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
    shared.count = count;
    shared.portion = std::max<std::size_t>(1, count / (threads_ * portions_per_thread));
    shared.next = 0;
    shared.failure = nullptr;
    shared.working = shared.members.size();
    ++shared.jobs;
  }
  shared.begun.notify_all();
  do_parts(shared);
  std::unique_lock lock(shared.mutex);
  shared.ended.wait(lock, [&shared] { return shared.working == 0; });
  if (shared.failure) std::rethrow_exception(std::exchange(shared.failure, nullptr));
}

void ThreadTeam::work(const std::stop_token& stop, Shared& shared) {
  std::size_t done = 0;
  while (true) {
    {
      std::unique_lock lock(shared.mutex);
      if (!shared.begun.wait(lock, stop, [&] { return shared.jobs != done; })) return;
      done = shared.jobs;
    }
    do_parts(shared);
    const std::scoped_lock lock(shared.mutex);
    if (--shared.working == 0) shared.ended.notify_one();
  }
}

void ThreadTeam::do_parts(Shared& shared) {
  while (true) {
    const std::size_t begin = shared.next.fetch_add(shared.portion);
    if (begin >= shared.count) return;
    for (std::size_t i = begin; i < std::min(begin + shared.portion, shared.count); ++i) {
      try {
        (*shared.part)(i);
      } catch (...) {
        const std::scoped_lock lock(shared.mutex);
        if (!shared.failure) shared.failure = std::current_exception();
      }
    }
  }
}

}  // namespace aloft::python
