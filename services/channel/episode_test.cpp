// The channel's side of the lock-step protocol, without a bus: every command is executed once.
#include "services/channel/episode.hpp"

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include "common/base/digest.hpp"
#include "common/bus/validate.hpp"
#include "common/flight/testing/synthetic_map.hpp"
#include "services/channel/agent_directory.hpp"
#include "services/channel/outbox.hpp"
#include "services/channel/trials.hpp"

namespace aloft::channel {
namespace {

using namespace std::chrono_literals;
using Outcome = Episode::Outcome;

const Clock::time_point start = Clock::now();

struct Talk {
  explicit Talk(const nlohmann::json& agent, agents::Privilege privilege = agents::Privilege::none)
      : spec(agents::parse_agents(agent, "test").at(0)),
        episode({.experiment_id = "e", .episode_id = 99, .attempt = 4, .stream = 7}, spec, privilege, map, 1,
                {.energy_weight = 0.01}, start) {}

  void ask(Clock::time_point now = start) {
    profiles.clear();
    maps.clear();
    episode.ask({[this](wire::SiteMap& sample) { maps.push_back(sample); },
                 [this](wire::HeightProfile& profile) { profiles.push_back(profile.step()); },
                 [this](wire::ChannelReport& report) { last_report = report; }},
                now);
  }

  [[nodiscard]] wire::HeightCommand command(std::uint32_t step, wire::Action action = wire::ACTION_UP) const {
    wire::HeightCommand message;
    message.stream(7);
    message.episode_id(99);
    message.attempt(4);
    message.step(step);
    message.agent(wire::name(spec.name));
    message.action(action);
    return message;
  }

  flight::SyntheticMap map = flight::SyntheticMap::random(radio::QosKind::spectral_efficiency, 3, 5, 1);
  agents::AgentSpec spec;
  Episode episode;
  wire::ChannelReport last_report;
  std::vector<wire::SiteMap> maps;
  std::vector<std::uint32_t> profiles;
};

}  // namespace

TEST_CASE("every command is executed once; the last one ends the flight") {
  Talk talk("constant-60");
  talk.ask();
  CHECK(talk.last_report.step() == 0);
  CHECK(talk.last_report.height_m() == 40.0);
  CHECK(talk.last_report.executed() == wire::ACTION_NONE);
  CHECK(talk.episode.accept(talk.command(2), start) == Outcome::ignored);
  CHECK(talk.episode.accept(talk.command(1), start) == Outcome::stepped);
  CHECK(talk.episode.accept(talk.command(1), start) == Outcome::ignored);
  talk.ask();
  CHECK(talk.last_report.step() == 1);
  CHECK(talk.last_report.height_m() == 50.0);
  CHECK(talk.last_report.executed() == wire::ACTION_UP);
  // A second at 10 m/s and 10 m of climb take 126.029 + 285.714 J.
  CHECK(talk.last_report.reward() == Approx(talk.last_report.qos() - 4.11743).epsilon(1e-5));
  CHECK(wire::view(talk.last_report.executed_by()) == "constant-60");
  CHECK(talk.episode.accept(talk.command(2), start) == Outcome::stepped);
  CHECK(talk.episode.accept(talk.command(3), start) == Outcome::finished);
  talk.ask();
  CHECK(talk.last_report.last());
  CHECK(talk.episode.accept(talk.command(4), start) == Outcome::ignored);
  CHECK(talk.episode.flight().record().steps.size() == 3);
}

TEST_CASE("commands of other agents or earlier attempts, and forbidden jumps, change nothing") {
  Talk talk("constant-60");
  wire::HeightCommand other = talk.command(1);
  other.agent(wire::name("constant-120"));
  CHECK(talk.episode.accept(other, start) == Outcome::ignored);
  wire::HeightCommand old = talk.command(1);
  old.attempt(3);
  CHECK(talk.episode.accept(old, start) == Outcome::ignored);
  CHECK(talk.episode.accept(talk.command(1, wire::ACTION_ABSOLUTE), start) == Outcome::forbidden);
  CHECK(talk.episode.accept(talk.command(1, wire::ACTION_UNKNOWN_FLIGHT), start) == Outcome::lost);
  CHECK(talk.episode.flight().record().steps.empty());
  Talk jumper("optimal-height");
  wire::HeightCommand jump = jumper.command(1, wire::ACTION_ABSOLUTE);
  jump.height_m(80.0);
  CHECK(jumper.episode.accept(jump, start) == Outcome::stepped);
  CHECK(jumper.episode.flight().observation().height_m == 80.0);
}

TEST_CASE("the flight of an agent that remembers is over when its memory has arrived") {
  Talk talk({{"type", "dqn"}, {"memory", "lifelong"}});
  wire::FlightMemory memory;
  memory.episode_id(99);
  memory.attempt(4);
  memory.agent(wire::name("dqn"));
  memory.memory({1, 2, 3});
  CHECK(talk.episode.accept(memory) == Outcome::ignored);  // the flight has just begun
  for (const std::uint32_t step : {1U, 2U, 3U}) {
    talk.ask();
    CHECK(talk.episode.accept(talk.command(step), start) == Outcome::stepped);
  }
  talk.ask();
  CHECK(talk.last_report.last());
  CHECK(talk.episode.repeat_due(start + 1s));
  CHECK(talk.episode.accept(talk.command(4), start) == Outcome::ignored);
  wire::FlightMemory old = memory;
  old.attempt(3);
  CHECK(talk.episode.accept(old) == Outcome::ignored);
  SECTION("the memory arrives") {
    CHECK(talk.episode.accept(memory) == Outcome::finished);
    CHECK(talk.episode.agent_memory() == std::vector<std::uint8_t>{1, 2, 3});
  }
  SECTION("the agent has died with its memory") {
    CHECK(talk.episode.accept(talk.command(4, wire::ACTION_UNKNOWN_FLIGHT), start) == Outcome::lost);
  }
}

TEST_CASE("the first report is repeated soon, later ones after a second") {
  Talk talk("constant-60");
  talk.ask();
  CHECK_FALSE(talk.episode.repeat_due(start + 99ms));
  CHECK(talk.episode.repeat_due(start + 100ms));
  CHECK(talk.episode.accept(talk.command(1), start + 10ms) == Outcome::stepped);
  talk.ask(start + 10ms);
  CHECK_FALSE(talk.episode.repeat_due(start + 1009ms));
  CHECK(talk.episode.repeat_due(start + 1010ms));
  CHECK(talk.episode.silence(start + 3010ms) == 3s);
}

TEST_CASE("only privileged agents see the future, and only as much as they declared") {
  Talk blind("constant-60");
  blind.ask();
  CHECK(blind.profiles.empty());
  Talk next("one-step-ahead", agents::Privilege::next_step);
  next.ask();
  CHECK(next.profiles == std::vector<std::uint32_t>{1});
  CHECK(next.episode.accept(next.command(1), start) == Outcome::stepped);
  next.ask();
  CHECK(next.profiles == std::vector<std::uint32_t>{2});
  Talk route("planner", agents::Privilege::whole_route);
  route.ask();
  CHECK(route.profiles == std::vector<std::uint32_t>{1, 2, 3});
  for (const Talk* talk : {&blind, &next, &route}) CHECK(talk->maps.empty());
}

TEST_CASE("only agents with the site map get it: with the first report, and with reports that are sent again") {
  Talk talk("site-planner", agents::Privilege::site_map);
  talk.ask();
  REQUIRE(talk.maps.size() == 1);
  const wire::SiteMap& map = talk.maps.front();
  CHECK(map.stream() == 7);
  CHECK(map.episode_id() == 99);
  CHECK(map.attempt() == 4);
  CHECK(map.step() == 0);
  CHECK_FALSE(map.update());
  CHECK(map.sites().size() == 12);
  CHECK(map.route().size() == 3);
  CHECK(talk.profiles.empty());
  CHECK(talk.episode.accept(talk.command(1), start) == Outcome::stepped);
  talk.ask();
  CHECK(talk.maps.empty());  // it is known
  talk.ask();
  REQUIRE(talk.maps.size() == 1);
  CHECK(talk.maps.front().step() == 1);
  CHECK_FALSE(talk.maps.front().update());
  CHECK(talk.maps.front().route().size() == 2);
}

TEST_CASE("a route told in parts: an update with every further report but the last") {
  Talk talk("site-planner", agents::Privilege::site_map);
  talk.map.tell_route_in_parts(2);
  for (std::uint32_t step = 0; step <= 3; ++step) {
    INFO("step " << step);
    talk.ask();
    REQUIRE(talk.maps.size() == (step < 3 ? 1 : 0));
    if (step < 3) {
      CHECK(talk.maps.front().step() == step);
      CHECK(talk.maps.front().update() == (step > 0));
      CHECK(talk.maps.front().sites().size() == (step > 0 ? 0 : 12));
      CHECK(talk.maps.front().route().size() == std::min(2U, 3 - step));
      CHECK(bus::validate(talk.maps.front()) == nullptr);
      CHECK(talk.episode.accept(talk.command(step + 1), start) != Outcome::ignored);
    }
  }
}

TEST_CASE("records are sent again until they are confirmed") {
  Outbox outbox;
  wire::EpisodeRecord record;
  record.episode_id(5);
  record.lease_id(77);
  record.trace({1, 2, 3});
  const std::string digest = sha256_hex("\x01\x02\x03");
  outbox.add(record, start);
  int sent = 0;
  const auto count = [&](wire::EpisodeRecord&) { ++sent; };
  outbox.send_due(start, count);
  outbox.send_due(start + 1999ms, count);
  CHECK(sent == 1);
  outbox.send_due(start + 2s, count);
  CHECK(sent == 2);
  CHECK(outbox.silence(start + 4s) == 4s);
  outbox.start_over();
  outbox.send_due(start + 2s, count);
  CHECK(sent == 3);
  CHECK_FALSE(outbox.settle(6, digest, start + 4s));
  CHECK(outbox.settle(5, digest, start + 4s) == 77);
  CHECK_FALSE(outbox.settle(5, digest, start + 4s));
  CHECK(outbox.size() == 0);
}

TEST_CASE("a message about another trace does not settle a record") {
  Outbox outbox;
  wire::EpisodeRecord record;
  record.episode_id(5);
  record.trace({1, 2, 3});
  outbox.add(record, start);
  CHECK_FALSE(outbox.settle(5, sha256_hex("another trace"), start));
  CHECK_FALSE(outbox.settle(5, std::string(64, '0'), start));
  CHECK(outbox.size() == 1);
}

TEST_CASE("an agent is there as long as it sends its status") {
  AgentDirectory agents;
  wire::AgentStatus status;
  status.agent(wire::name("dqn"));
  status.process(wire::name("aloft-learning-agent"));
  status.state(wire::AGENT_READY);
  CHECK(agents.update(status, start));
  CHECK_FALSE(agents.update(status, start + 1s));
  CHECK(agents.expire(start + 4s).empty());
  CHECK(agents.find("dqn") != nullptr);
  CHECK(agents.expire(start + 4001ms) ==
        std::map<std::string, std::vector<std::string>>{{"aloft-learning-agent", {"dqn"}}});
  CHECK(agents.find("dqn") == nullptr);
  CHECK(agents.update(status, start));
  status.state(wire::AGENT_STOPPED);
  agents.update(status, start);
  CHECK(agents.find("dqn") == nullptr);
}

TEST_CASE("agents that are lost with their process are reported together") {
  AgentDirectory agents;
  for (const auto& [agent, process] :
       std::map<std::string, std::string>{{"dqn", "learner"}, {"min-height", "baselines"}, {"planner", "baselines"}}) {
    wire::AgentStatus status;
    status.agent(wire::name(agent));
    status.process(wire::name(process));
    status.state(wire::AGENT_READY);
    CHECK(agents.update(status, agent == "dqn" ? start + 2s : start));
  }
  CHECK(agents.expire(start + 4s) ==
        std::map<std::string, std::vector<std::string>>{{"baselines", {"min-height", "planner"}}});
  CHECK(agents.expire(start + 4s).empty());
}

TEST_CASE("lanes are given to one trial at a time, and past leases are remembered") {
  Trials trials(2);
  Trial& a = trials.add(1, 0, 0, {"x"});
  Trial& b = trials.add(2, 0, 1, {});
  Trial& c = trials.add(3, 0, 2, {"x"});
  CHECK(trials.take_lane(a));
  CHECK(trials.take_lane(b));
  CHECK_FALSE(trials.take_lane(c));
  CHECK(a.lane != b.lane);
  CHECK(trials.waiting_for_storage() == 1);
  trials.remove(2);
  CHECK(trials.take_lane(c));
  CHECK(trials.knows(2));
  CHECK(trials.find(2) == nullptr);
  CHECK_FALSE(trials.knows(4));
}

}  // namespace aloft::channel
