#include "services/coordinator/namesakes.hpp"

#include <catch2/catch.hpp>

using namespace aloft::coordinator;
using namespace std::chrono_literals;
using Verdict = Namesakes::Verdict;

namespace {

const Namesakes::Clock::time_point start{};

Namesakes::Voice alpha(Namesakes::Clock::duration since) {
  return {1, "alpha", 12, start + since};
}
Namesakes::Voice beta(Namesakes::Clock::duration since) {
  return {2, "beta", 34, start + since};
}

}  // namespace

TEST_CASE("a worker that was restarted is no namesake") {
  Namesakes names;
  CHECK(names.hear("w0", alpha(0s), false) == Verdict::alone);
  CHECK(names.hear("w0", alpha(500ms), false) == Verdict::alone);
  CHECK(names.hear("w0", beta(600ms), false) == Verdict::alone);
  for (auto at = 1s; at < 20s; at += 1s) CHECK(names.hear("w0", beta(at), false) == Verdict::alone);
  CHECK(names.text(start + 20s).empty());
}

TEST_CASE("two workers of one name are held back and named, until one of them is gone") {
  Namesakes names;
  CHECK(names.hear("w0", alpha(0s), false) == Verdict::alone);
  CHECK(names.hear("w1", beta(0s), false) == Verdict::alone);
  CHECK(names.hear("w0", beta(100ms), false) == Verdict::alone);
  CHECK(names.hear("w0", alpha(500ms), false) == Verdict::doubled);
  CHECK(names.hear("w0", beta(600ms), false) == Verdict::held_back);
  CHECK(names.hear("w0", alpha(1s), false) == Verdict::held_back);
  CHECK(names.text(start + 1s) ==
        "2 workers are called w0: on host alpha (process 12) and on host beta (process 34); none of them gets trials "
        "until the others end");
  CHECK(names.hear("w1", beta(1s), false) == Verdict::alone);
  SECTION("because it leaves, and was the last to report") {
    CHECK(names.hear("w0", beta(1050ms), false) == Verdict::held_back);
    CHECK(names.hear("w0", beta(1100ms), true) == Verdict::other_left);
    CHECK(names.hear("w0", alpha(1200ms), false) == Verdict::alone);
  }
  SECTION("because it is silent") {
    CHECK(names.hear("w0", alpha(3600ms), false) == Verdict::held_back);
    CHECK(names.hear("w0", alpha(3601ms), false) == Verdict::alone);
  }
  CHECK(names.text(start + 3601ms).empty());
}

TEST_CASE("a worker that leaves is gone, and does not take a namesake with it") {
  Namesakes names;
  CHECK(names.hear("w0", alpha(0s), false) == Verdict::alone);
  CHECK(names.hear("w0", beta(100ms), false) == Verdict::alone);  // it replaces alpha, whose farewell comes late
  CHECK(names.hear("w0", alpha(200ms), true) == Verdict::other_left);
  CHECK(names.hear("w0", beta(300ms), true) == Verdict::alone);
  CHECK(names.hear("w0", alpha(400ms), false) == Verdict::alone);
}
