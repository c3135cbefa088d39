// The channel's side of flights that several agents share, without a bus.
#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include "common/flight/testing/synthetic_map.hpp"
#include "services/channel/relay/swap_desk.hpp"

namespace aloft::channel {
namespace {

using namespace std::chrono_literals;
using Catch::Contains;
using Outcome = Episode::Outcome;

const Clock::time_point start = Clock::now();

const char* const written_crew = R"([{"agent": "min-height"}, {"agent": "constant-60", "from_step": 3},
                                     {"agent": "random-walk", "from_step": 5, "shadow": false}])";
const char* const standby_crew = R"([{"agent": "min-height"}, {"agent": "constant-60"}, {"agent": "random-walk"}])";

experiment::Experiment experiment_with(const std::string& crew, const std::string& on_agent_loss) {
  return experiment::parse(
      R"({"name": "test", "trials": 1, "world": {"steps": 9}, "on_agent_loss": ")" + on_agent_loss +
          R"(", "agents": ["constant-80", {"type": "relay", "name": "both", "crew": )" + crew + "}]}",
      "test");
}

struct Talk {
  explicit Talk(const char* crew, bool failover)
      : experiment(experiment_with(crew, failover ? "failover" : "restart")),
        episode(std::make_unique<Episode>(
            EpisodeAddress{.experiment_id = "e", .episode_id = 99, .attempt = 4, .stream = 7}, experiment.agents.at(1),
            agents::Privilege::none, map, 1, flight::Costs{}, start, failover)) {}

  std::string asked() {
    std::string name;
    episode->ask({[](wire::SiteMap&) {}, [](wire::HeightProfile&) {},
                  [&](wire::ChannelReport& report) {
                    CHECK(wire::view(report.relay()) == "both");
                    name = report.agent().to_string();
                  }},
                 now);
    return name;
  }
  [[nodiscard]] std::uint32_t step() const { return episode->flight().observation().step; }
  Outcome command(const char* agent, wire::Action action = wire::ACTION_HOLD) {
    wire::HeightCommand message;
    message.episode_id(99);
    message.attempt(4);
    message.step(step() + 1);
    message.agent(wire::name(agent));
    message.action(action);
    return episode->accept(message, now);
  }
  Outcome follow(const char* agent, bool unknown_flight = false) {
    wire::ReportFollowed message;
    message.episode_id(99);
    message.attempt(4);
    message.step(step());
    message.agent(wire::name(agent));
    message.unknown_flight(unknown_flight);
    return episode->accept(message, now);
  }
  /// One step by this pilot that all others follow.
  void fly(const char* pilot) {
    for (const agents::CrewMember& member : episode->agent().crew)
      if (member.agent.name != pilot) follow(member.agent.name.c_str());
    REQUIRE(command(pilot) == Outcome::stepped);
  }
  [[nodiscard]] std::vector<std::string> pilots() const {
    const flight::FlightRecord& record = episode->flight().record();
    std::vector<std::string> names;
    for (const flight::StepRecord& one : record.steps) names.push_back(record.pilots.at(one.flown_by));
    return names;
  }

  flight::SyntheticMap map = flight::SyntheticMap::random(radio::QosKind::spectral_efficiency, 9, 5, 1);
  experiment::Experiment experiment;
  std::unique_ptr<Episode> episode;
  Clock::time_point now = start;
};

}  // namespace

TEST_CASE("restart: only the asked agent's command is executed, and only after all aboard have followed") {
  Talk talk(written_crew, false);
  CHECK(talk.asked() == "min-height");
  CHECK(talk.command("constant-60") == Outcome::ignored);
  CHECK(talk.command("min-height") == Outcome::ignored);  // held: constant-60 is aboard from the start
  CHECK(talk.episode->awaited() == "constant-60");
  CHECK(talk.follow("min-height") == Outcome::ignored);
  CHECK(talk.follow("constant-60") == Outcome::stepped);
  CHECK(talk.follow("constant-60") == Outcome::ignored);  // the other order
  CHECK(talk.command("min-height") == Outcome::stepped);
  CHECK(talk.asked() == "constant-60");
  CHECK(talk.command("min-height") == Outcome::ignored);
  talk.now += 10s;  // no other member takes over, however long it lasts
  CHECK(talk.command("min-height") == Outcome::ignored);
  CHECK(talk.episode->wait_no_longer(talk.now) == Outcome::ignored);
  talk.fly("constant-60");
  talk.fly("constant-60");
  CHECK(talk.asked() == "random-walk");  // comes aboard with report 4
  CHECK(talk.follow("min-height") == Outcome::ignored);
  CHECK(talk.follow("constant-60") == Outcome::ignored);
  CHECK(talk.command("random-walk") == Outcome::stepped);
  CHECK(talk.pilots() ==
        std::vector<std::string>{"min-height", "min-height", "constant-60", "constant-60", "random-walk"});
  SECTION("a member that has missed a report makes the flight start again") {
    CHECK(talk.follow("min-height", true) == Outcome::lost);
    CHECK(talk.command("random-walk", wire::ACTION_UNKNOWN_FLIGHT) == Outcome::lost);
  }
}

TEST_CASE("failover: a member takes over from a silent pilot, and silent members are not waited for") {
  Talk talk(standby_crew, true);
  talk.fly("min-height");
  CHECK(talk.asked() == "min-height");
  talk.follow("random-walk");
  talk.now += 500ms;
  CHECK(talk.command("constant-60") == Outcome::ignored);  // the pilot may only be slow
  talk.now += 100ms;
  CHECK(talk.command("constant-60") == Outcome::stepped);
  CHECK(talk.asked() == "constant-60");
  CHECK(talk.follow("random-walk") == Outcome::ignored);
  CHECK(talk.command("constant-60") == Outcome::stepped);  // min-height is not waited for
  CHECK(talk.command("min-height") == Outcome::ignored);   // and is not asked when it is back
  CHECK(talk.follow("min-height", true) == Outcome::ignored);
  CHECK(talk.follow("min-height") == Outcome::ignored);
  CHECK(talk.command("constant-60") == Outcome::ignored);  // back aboard, it learns first; so does random-walk
  CHECK(talk.episode->awaited() == "random-walk");
  CHECK(talk.episode->wait_no_longer(talk.now + 999ms) == Outcome::ignored);
  CHECK(talk.episode->wait_no_longer(talk.now + 1s) == Outcome::stepped);
  CHECK(talk.pilots() == std::vector<std::string>{"min-height", "constant-60", "constant-60", "constant-60"});
}

TEST_CASE("failover: an agent that cannot go on passes the step on; if no member can fly it, the flight starts again") {
  Talk talk(standby_crew, true);
  talk.fly("min-height");
  CHECK(talk.command("min-height", wire::ACTION_UNKNOWN_FLIGHT) == Outcome::passed_on);
  CHECK(talk.asked() == "constant-60");
  CHECK(talk.command("constant-60", wire::ACTION_UNKNOWN_FLIGHT) == Outcome::passed_on);
  CHECK(talk.command("random-walk", wire::ACTION_UNKNOWN_FLIGHT) == Outcome::lost);
}

TEST_CASE("failover: members that are not there when the flight begins are neither asked nor waited for") {
  SECTION("a follower is absent") {
    Talk talk(standby_crew, true);
    talk.episode->do_without({"random-walk"}, start);
    CHECK(talk.command("min-height") == Outcome::ignored);  // constant-60 is there
    CHECK(talk.episode->awaited() == "constant-60");
    CHECK(talk.follow("constant-60") == Outcome::stepped);
    CHECK(talk.follow("constant-60") == Outcome::ignored);
    CHECK(talk.command("min-height") == Outcome::stepped);
    CHECK(talk.follow("random-walk") == Outcome::ignored);  // it has come aboard, and is waited for again
    talk.follow("constant-60");
    CHECK(talk.command("min-height") == Outcome::stepped);
    talk.follow("constant-60");
    CHECK(talk.command("min-height") == Outcome::ignored);
    CHECK(talk.episode->awaited() == "random-walk");
  }
  SECTION("the first pilot is absent: the next one flies at once, and goes on when the first is back") {
    Talk talk(standby_crew, true);
    talk.episode->do_without({"min-height"}, start);
    CHECK(talk.asked() == "constant-60");
    talk.follow("random-walk");
    CHECK(talk.command("constant-60") == Outcome::stepped);
    talk.fly("constant-60");
    CHECK(talk.asked() == "constant-60");
    CHECK(talk.pilots() == std::vector<std::string>{"constant-60", "constant-60"});
  }
  SECTION("the pilot of a later step is absent, unless it has arrived by then") {
    const bool comes = GENERATE(true, false);
    Talk talk(written_crew, true);
    talk.episode->do_without({"constant-60"}, start);
    CHECK(talk.command("min-height") == Outcome::stepped);
    if (comes) talk.episode->comes("constant-60");  // not aboard: it is asked, but not waited for
    CHECK(talk.command("min-height") == Outcome::stepped);
    CHECK(talk.asked() == (comes ? "constant-60" : "min-height"));
  }
  SECTION("the pilot fails, and only members that are there can go on") {
    Talk talk(standby_crew, true);
    talk.episode->do_without({"constant-60"}, start);
    CHECK(talk.command("min-height", wire::ACTION_UNKNOWN_FLIGHT) == Outcome::passed_on);
    CHECK(talk.asked() == "random-walk");
    CHECK(talk.command("random-walk", wire::ACTION_UNKNOWN_FLIGHT) == Outcome::lost);
  }
  SECTION("all are absent: the first is asked") {
    Talk talk(standby_crew, true);
    talk.episode->do_without({"min-height", "constant-60", "random-walk"}, start);
    CHECK(talk.asked() == "min-height");
  }
  SECTION("without failover all members are waited for") {
    Talk talk(written_crew, false);
    talk.episode->do_without({"constant-60"}, start);
    CHECK(talk.command("min-height") == Outcome::ignored);
    CHECK(talk.episode->awaited() == "constant-60");
  }
}

TEST_CASE("flights wait for an absent agent once, until its next status") {
  AgentDirectory agents;
  const auto says = [&](wire::AgentState state, Clock::time_point now) {
    wire::AgentStatus status;
    status.agent(wire::name("random-walk"));
    status.state(state);
    agents.update(status, now);
  };
  CHECK_FALSE(agents.waited_long("random-walk", start));
  agents.miss("random-walk", start);
  agents.miss("random-walk", start + 2s);  // the wait counts from the first time
  CHECK_FALSE(agents.waited_long("random-walk", start + 3s));
  CHECK(agents.waited_long("random-walk", start + 3001ms));
  CHECK_FALSE(agents.waited_long("min-height", start + 3001ms));
  agents.miss("random-walk", start + 60s);  // the next flight does not wait
  CHECK(agents.waited_long("random-walk", start + 60s));

  says(wire::AGENT_READY, start + 61s);
  CHECK_FALSE(agents.waited_long("random-walk", start + 61s));
  says(wire::AGENT_STOPPED, start + 62s);
  agents.miss("random-walk", start + 63s);
  CHECK_FALSE(agents.waited_long("random-walk", start + 66s));
  CHECK(agents.waited_long("random-walk", start + 67s));
}

TEST_CASE("an order takes effect at its step, once, and holds for later flights") {
  Talk talk(standby_crew, true);
  AgentDirectory agents;
  for (const char* name : {"min-height", "constant-60", "random-walk"}) {
    wire::AgentStatus status;
    status.agent(wire::name(name));
    agents.update(status, start);
  }
  SwapDesk desk;
  SwapDesk::Episodes episodes;
  episodes.push_back(std::move(talk.episode));
  talk.episode = nullptr;
  Episode& episode = *episodes[0];
  const auto ask_for = [&](std::uint64_t id, const char* agent, std::uint32_t from_step) {
    wire::SwapRequest request;
    request.request_id(id);
    request.agent(wire::name(agent));
    request.from_step(from_step);
    return desk.handle(request, talk.experiment, agents, episodes, start).size();
  };
  CHECK(ask_for(1, "random-walk", 3) == 0);
  CHECK(desk.reply().accepted());
  CHECK(desk.reply().flights_waiting() == 1);
  CHECK(episode.pilot().name == "min-height");

  talk.episode = std::move(episodes[0]);
  talk.fly("min-height");
  talk.fly("min-height");
  CHECK(talk.asked() == "random-walk");
  talk.fly("random-walk");
  episodes[0] = std::move(talk.episode);
  CHECK(desk.recount(episodes));
  CHECK(desk.reply().flights_waiting() == 0);
  CHECK(desk.reply().flights_flown() == 1);

  CHECK(ask_for(2, "constant-60", 0) == 1);
  CHECK(ask_for(2, "constant-60", 0) == 0);  // the same request again
  CHECK(episodes[0]->pilot().name == "constant-60");

  Talk later(standby_crew, true);
  desk.brief(*later.episode, start);
  CHECK(later.asked() == "constant-60");
}

TEST_CASE("an order for later flights is checked against the longest of them, if their lengths are known") {
  AgentDirectory agents;
  wire::AgentStatus status;
  status.agent(wire::name("random-walk"));
  agents.update(status, start);
  const auto accepted = [&](const std::string& worlds, std::uint32_t from_step) {
    const auto experiment =
        experiment::parse(R"({"name": "test", "trials": 1, "worlds": [)" + worlds + R"(], "on_agent_loss": "failover",
            "agents": [{"type": "relay", "name": "both", "crew": )" +
                              standby_crew + "}]}",
                          "test");
    SwapDesk desk;
    wire::SwapRequest request;
    request.request_id(5);
    request.agent(wire::name("random-walk"));
    request.from_step(from_step);
    (void)desk.handle(request, experiment, agents, {}, start);
    return desk.reply().accepted();
  };
  const std::string two = R"({"name": "short", "steps": 9}, {"name": "long", "steps": 50})";
  CHECK(accepted(two, 50));
  CHECK_FALSE(accepted(two, 51));
  const std::string measured =
      R"({"kind": "measured", "file": "/nowhere/x.csv", "file_sha256": ")" + std::string(64, '0') + "\"}";
  CHECK(accepted(two + ", " + measured, 9999));  // its length is unknown
}

TEST_CASE("impossible swaps are refused, with what to do") {
  AgentDirectory agents;
  const SwapDesk::Episodes none;
  const auto refusal = [&](const experiment::Experiment& experiment, const char* agent, std::uint32_t from_step,
                           const SwapDesk::Episodes& episodes) {
    SwapDesk desk;
    wire::SwapRequest request;
    request.request_id(5);
    request.agent(wire::name(agent));
    request.from_step(from_step);
    CHECK(desk.handle(request, experiment, agents, episodes, start).empty());
    CHECK_FALSE(desk.reply().accepted());
    return desk.reply().message().to_string();
  };
  Talk talk(standby_crew, true);
  CHECK_THAT(refusal(talk.experiment, "random-wlak", 0, none),
             Contains("random-wlak") && Contains("Did you mean 'random-walk'"));
  CHECK_THAT(refusal(talk.experiment, "constant-80", 0, none), Contains("in no crew") && Contains("constant-60"));
  CHECK_THAT(refusal(talk.experiment, "random-walk", 0, none), Contains("not there"));
  wire::AgentStatus status;
  status.agent(wire::name("random-walk"));
  agents.update(status, start);
  SwapDesk::Episodes episodes;
  episodes.push_back(std::move(talk.episode));
  CHECK_THAT(refusal(talk.experiment, "random-walk", 10, episodes), Contains("10") && Contains("1 to 9"));
  CHECK_THAT(refusal(talk.experiment, "random-walk", 10, none),
             Contains("no flight of experiment 'test' has more than 9"));
  CHECK_THAT(refusal(experiment_with(written_crew, "restart"), "random-walk", 0, none),
             Contains("from_step") && Contains("failover"));
  CHECK_THAT(refusal(experiment::parse(R"({"name": "t", "trials": 1, "world": {}, "agents": ["min-height"]})", "test"),
                     "min-height", 0, none),
             Contains("relay"));
}

}  // namespace aloft::channel
