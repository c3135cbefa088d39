#include "services/channel/missing_peers.hpp"

#include <spdlog/sinks/ostream_sink.h>
#include <spdlog/spdlog.h>

#include <catch2/catch.hpp>
#include <sstream>

namespace aloft::channel {
namespace {

using namespace std::chrono_literals;

const Clock::time_point start = Clock::now();

MissingPeers::Facts all_well() {
  return {.environment_there = true};
}

/// What is logged while the object lives.
class Log {
 public:
  Log() {
    spdlog::set_default_logger(
        std::make_shared<spdlog::logger>("test", std::make_shared<spdlog::sinks::ostream_sink_mt>(text_)));
    spdlog::set_pattern("%v");
  }
  ~Log() { spdlog::set_default_logger(before_); }
  Log(const Log&) = delete;
  Log& operator=(const Log&) = delete;
  std::string take() {
    std::string text = text_.str();
    text_.str("");
    return text;
  }

 private:
  std::shared_ptr<spdlog::logger> before_ = spdlog::default_logger();
  std::ostringstream text_;
};

}  // namespace

TEST_CASE("a worker names the peers it waits for") {
  MissingPeers missing(start);
  MissingPeers::Facts facts = all_well();
  missing.update(facts, start);
  CHECK(missing.text().empty());

  facts.silent_agents = {{"dqn", 4s}, {"planner", 7s}};
  missing.update(facts, start);
  CHECK(missing.text() == "agents dqn, planner (no command for 7 s)");

  facts.absent_agents = {"min-height"};
  facts.collector_silence = 4s;
  facts.records_unconfirmed = 3;
  missing.update(facts, start);
  CHECK(missing.text() ==
        "agents dqn, planner (no command for 7 s), agent min-height (not there), "
        "the collector (3 records unconfirmed)");

  facts = all_well();
  facts.collector_silence = MissingPeers::patience;  // not longer
  missing.update(facts, start);
  CHECK(missing.text().empty());
}

TEST_CASE("the environment is missed three seconds after it was there last") {
  MissingPeers missing(start);
  missing.update({}, start + 3s);
  CHECK(missing.text().empty());
  missing.update({}, start + 3001ms);
  CHECK(missing.text() == "the environment (not there)");
  missing.update(all_well(), start + 5s);
  CHECK(missing.text().empty());
  missing.update({}, start + 8s);
  CHECK(missing.text().empty());
}

TEST_CASE("the log reports when the missing peers change, not how long they are missing") {
  Log log;
  MissingPeers missing(start);
  MissingPeers::Facts facts = all_well();
  missing.update(facts, start);
  CHECK(log.take().empty());
  facts.silent_agents = {{"dqn", 4s}};
  missing.update(facts, start);
  CHECK(log.take() == "waits for agent dqn (no command for 4 s)\n");
  facts.silent_agents = {{"dqn", 5s}};
  missing.update(facts, start);
  CHECK(log.take().empty());
  CHECK(missing.text() == "agent dqn (no command for 5 s)");
  missing.update(all_well(), start);
  CHECK(log.take() == "no peer is missing any more\n");
}

}  // namespace aloft::channel
