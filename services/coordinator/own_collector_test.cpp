#include "services/coordinator/own_collector.hpp"

#include <catch2/catch.hpp>

using namespace aloft;
using namespace aloft::coordinator;
using namespace std::chrono_literals;
using Verdict = OwnCollector::Verdict;
using Folder = OwnCollector::Folder;

namespace {

const OwnCollector::Clock::time_point start{};
const Folder no_database{};

ProcessName process(std::uint64_t incarnation, const std::string& host = "here") {
  return {incarnation, host, 12, 1};
}
OwnCollector::News news(std::uint64_t incarnation, const std::string& host = "here",
                        const std::string& results = "/out", std::uint64_t stored = 0) {
  return {process(incarnation, host), results, stored};
}
Folder signed_by(std::uint64_t incarnation) {
  return {true, process(incarnation)};
}

}  // namespace

TEST_CASE("the run's own collector is the one that signed the database in the coordinator's folder") {
  OwnCollector collectors("here", start);
  CHECK_FALSE(collectors.own());
  CHECK(collectors.hear(news(5), signed_by(7), start + 1s) == Verdict::foreign);
  CHECK(collectors.refused().empty());
  CHECK(collectors.hear(news(7), signed_by(7), start + 1s) == Verdict::now_own);
  CHECK(collectors.hear(news(7, "here", "/out", 3), no_database, start + 1s) == Verdict::own);
  CHECK(collectors.own()->flights_stored == 3);
  CHECK(collectors.hear(news(5), signed_by(7), start + 2s) == Verdict::now_refused);
  CHECK(collectors.hear(news(5), signed_by(7), start + 3s) == Verdict::foreign);
  CHECK(collectors.refused() == std::vector<std::uint64_t>{5});
  CHECK(collectors.own()->process.incarnation == 7);
}

TEST_CASE("a collector that was restarted on the same database is let in; the second one stays out") {
  OwnCollector collectors("here", start);
  CHECK(collectors.hear(news(7), signed_by(7), start) == Verdict::now_own);
  CHECK(collectors.hear(news(5), signed_by(7), start + 9s) == Verdict::now_refused);
  CHECK(collectors.hear(news(8), signed_by(8), start + 10s) == Verdict::now_own);
  CHECK(collectors.own()->process.incarnation == 8);
  CHECK(collectors.hear(news(5), signed_by(8), start + 11s) == Verdict::foreign);
  CHECK(collectors.hear(news(7), signed_by(8), start + 11s) == Verdict::now_refused);  // it should be dead
}

TEST_CASE("without a signed database, no collector of this machine becomes the run's own") {
  OwnCollector collectors("here", start);
  CHECK(collectors.hear(news(5), {true, std::nullopt}, start + 5s) == Verdict::now_refused);
  CHECK(collectors.hear(news(6, "here", "/other"), no_database, start + 5s) == Verdict::now_refused);
  CHECK_FALSE(collectors.own());
}

TEST_CASE("on another host, the first collector is the run's own, and later one that continues its folder") {
  OwnCollector collectors("here", start);
  CHECK(collectors.hear(news(5, "there", "/a"), no_database, start) == Verdict::now_own);
  CHECK(collectors.hear(news(6, "there", "/b"), no_database, start + 5s) == Verdict::now_refused);
  CHECK(collectors.hear(news(7, "elsewhere", "/a"), no_database, start + 5s) == Verdict::now_refused);
  CHECK(collectors.hear(news(8, "there", "/a"), no_database, start + 5s) == Verdict::now_own);
  CHECK(collectors.own()->process.incarnation == 8);
}

TEST_CASE("the list of refused collectors is bounded, and keeps the latest") {
  OwnCollector collectors("here", start);
  for (std::uint64_t incarnation = 1; incarnation <= 20; ++incarnation)
    CHECK(collectors.hear(news(incarnation), signed_by(99), start + 5s) == Verdict::now_refused);
  CHECK(collectors.refused().size() == OwnCollector::refusals_kept);
  CHECK(collectors.refused().front() == 5);
  CHECK(collectors.refused().back() == 20);
}
