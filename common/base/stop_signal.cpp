#include "common/base/stop_signal.hpp"

#include <poll.h>
#include <pthread.h>
#include <sys/eventfd.h>
#include <sys/signalfd.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <csignal>
#include <system_error>

#include "common/base/error.hpp"

namespace aloft {
namespace {

sigset_t stop_signals() {
  sigset_t set;
  sigemptyset(&set);
  sigaddset(&set, SIGINT);
  sigaddset(&set, SIGTERM);
  return set;
}

}  // namespace

StopSignal::StopSignal() {
  const sigset_t set = stop_signals();
  pthread_sigmask(SIG_BLOCK, &set, nullptr);
  signal_fd_ = signalfd(-1, &set, SFD_CLOEXEC);
  end_fd_ = eventfd(0, EFD_CLOEXEC);
  if (signal_fd_ < 0 || end_fd_ < 0) throw std::system_error(errno, std::generic_category(), "cannot watch signals");
  thread_ = std::thread([this] { watch(); });
}

StopSignal::~StopSignal() {
  const std::uint64_t one = 1;
  if (write(end_fd_, &one, sizeof one) == sizeof one) thread_.join();
  close(signal_fd_);
  close(end_fd_);
  const sigset_t set = stop_signals();
  pthread_sigmask(SIG_UNBLOCK, &set, nullptr);
}

void StopSignal::request() {
  const std::lock_guard lock(calls_->mutex);
  if (requested_.exchange(true)) return;
  for (const auto& call : calls_->list) call();
}

StopSignal::Ticket StopSignal::on_request(std::function<void()> call) {
  const std::lock_guard lock(calls_->mutex);
  if (requested_) call();
  calls_->list.push_front(std::move(call));
  const auto place = calls_->list.begin();
  return {nullptr, [calls = calls_, place](void*) {
            const std::lock_guard removal(calls->mutex);
            calls->list.erase(place);
          }};
}

void StopSignal::watch() {
  std::array<pollfd, 2> descriptors{{{signal_fd_, POLLIN, 0}, {end_fd_, POLLIN, 0}}};
  for (;;) {
    if (poll(descriptors.data(), descriptors.size(), -1) < 0 && errno != EINTR) return;
    if (descriptors[1].revents != 0) return;
    signalfd_siginfo info{};
    if (descriptors[0].revents == 0 || read(signal_fd_, &info, sizeof info) != sizeof info) continue;
    if (interrupted_.exchange(true)) _exit(exit_interrupted);
    request();
  }
}

}  // namespace aloft
