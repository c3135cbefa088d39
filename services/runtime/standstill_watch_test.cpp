#include "services/runtime/standstill_watch.hpp"

#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <catch2/catch.hpp>
#include <thread>

using namespace std::chrono_literals;

TEST_CASE("a process that stood still notices, and one that runs does not") {
  constexpr auto limit = 2s;
  const pid_t child = fork();
  if (child == 0) {
    const aloft::runtime::StandstillWatch watch(limit, aloft::runtime::end_to_be_started_again());
    std::this_thread::sleep_for(60s);
    _exit(0);
  }
  std::this_thread::sleep_for(500ms);
  CHECK(waitpid(child, nullptr, WNOHANG) == 0);
  kill(child, SIGSTOP);
  std::this_thread::sleep_for(limit + 500ms);
  kill(child, SIGCONT);
  int status = 0;
  CHECK(waitpid(child, &status, 0) == child);
  CHECK(WIFEXITED(status));
  CHECK(WEXITSTATUS(status) == aloft::runtime::exit_start_again);
}
