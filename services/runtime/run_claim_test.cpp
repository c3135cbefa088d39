#include "services/runtime/run_claim.hpp"

#include <sys/wait.h>
#include <unistd.h>

#include <catch2/catch.hpp>
#include <csignal>
#include <string>

using aloft::runtime::RunClaim;

TEST_CASE("one process holds a claim, until it is gone") {
  const std::string run = "claim-" + std::to_string(getpid());
  RunClaim first(run, 3, "coordinator");
  CHECK(first.take());
  CHECK(first.take());
  {
    RunClaim second(run, 3, "coordinator");
    CHECK_FALSE(second.take());
  }
  CHECK_FALSE(RunClaim(run, 3, "coordinator").take());
  CHECK(RunClaim(run, 4, "coordinator").take());
  CHECK(RunClaim(run, 3, "run").take());
  CHECK(RunClaim(run + "x", 3, "coordinator").take());
}

TEST_CASE("a claim ends with its process, even with kill -9") {
  const std::string run = "claim-killed-" + std::to_string(getpid());
  int ready[2];
  REQUIRE(pipe(ready) == 0);
  const pid_t child = fork();
  if (child == 0) {
    RunClaim claim(run, 3, "coordinator");
    const char taken = claim.take() ? 'y' : 'n';
    (void)!write(ready[1], &taken, 1);
    pause();
  }
  char taken = 0;
  REQUIRE(read(ready[0], &taken, 1) == 1);
  CHECK(taken == 'y');
  RunClaim claim(run, 3, "coordinator");
  CHECK_FALSE(claim.take());
  kill(child, SIGKILL);
  waitpid(child, nullptr, 0);
  CHECK(claim.take());
}
