// A secured run against participants that do not belong to it: they read and write nothing, and are named in the log.
#include <spdlog/sinks/ostream_sink.h>
#include <spdlog/spdlog.h>
#include <sys/wait.h>
#include <unistd.h>

#include <catch2/catch.hpp>
#include <chrono>
#include <optional>
#include <sstream>
#include <thread>

#include "common/bus/endpoint.hpp"
#include "common/bus/keys.hpp"
#include "tests/integration/command.hpp"

using namespace aloft;
using namespace std::chrono_literals;
using Catch::Matchers::Contains;
namespace fs = std::filesystem;

namespace {

/// An authority with all roles, and what a test needs to meet its processes.
struct Scene {
  test::ScratchDir scratch;
  fs::path keys = scratch / "keys";
  bus::BusOptions place{.run = "security-test-" + std::to_string(getpid()),
                        .worker = "",
                        .process = "security-test",
                        .domain = std::stoi(test::test_domain())};
  std::ostringstream log;

  Scene() {
    bus::init_keys(keys, 10);
    for (const bus::Role role : bus::all_roles)
      bus::issue_keys(keys, {.role = role, .name = std::string(bus::to_text(role))}, keys);
    auto sink = std::make_shared<spdlog::sinks::ostream_sink_mt>(log, true);
    spdlog::set_default_logger(std::make_shared<spdlog::logger>("security-test", sink));
  }
  ~Scene() { spdlog::set_default_logger(std::make_shared<spdlog::logger>("")); }

  [[nodiscard]] bus::BusOptions as(bus::Role role, const fs::path& dir, const std::string& process = "") const {
    bus::BusOptions options = place;
    options.secure = dir;
    options.role = role;
    options.process = process.empty() ? std::string(bus::to_text(role)) : process;
    return options;
  }
  [[nodiscard]] bus::BusOptions as(bus::Role role) const { return as(role, keys); }
};

wire::TrialAssignment assignment() {
  wire::TrialAssignment sample;
  sample.worker("w0");
  sample.cancelled(true);
  return sample;
}

template <class Done>
bool within(std::chrono::milliseconds limit, Done done) {
  const auto end = std::chrono::steady_clock::now() + limit * test::slowdown;
  while (!done()) {
    if (std::chrono::steady_clock::now() > end) return false;
    std::this_thread::sleep_for(10ms);
  }
  return true;
}

/// The longest that a stranger is given to get through. Friends meet within a few hundred milliseconds.
constexpr auto patience = 2500ms;

/// A coordinator and an environment of the run, which hear each other before the stranger comes and after it has gone.
struct Friends {
  explicit Friends(const Scene& scene)
      : coordinator(scene.as(bus::Role::coordinator)), environment(scene.as(bus::Role::environment)) {
    REQUIRE(within(20s, [&] { return assignments.matched() == 1 && received.matched() == 1; }));
    REQUIRE(talk());
  }
  bool talk() {
    assignments.write(assignment());
    wire::TrialAssignment sample;
    return within(20s, [&] { return received.take(sample); });
  }
  bus::Participant coordinator;
  bus::Participant environment;
  bus::Writer<wire::TrialAssignment> assignments{coordinator};
  bus::Reader<wire::TrialAssignment> received{environment};
};

/// Somebody who writes and somebody who reads what is not for them: nothing comes through, friends are not disturbed.
void check_shut_out(Friends& friends, const bus::BusOptions& writing, const bus::BusOptions& reading) {
  const bus::Participant first(writing);
  const bus::Participant second(reading);
  bus::Writer<wire::TrialAssignment> writer(first);
  bus::Reader<wire::TrialAssignment> reader(second);
  wire::TrialAssignment forged = assignment();
  forged.worker("forged");
  wire::TrialAssignment sample;
  CHECK_FALSE(within(patience, [&] {
    writer.write(forged);
    return friends.received.take(sample) || reader.take(sample);
  }));
  CHECK(friends.received.matched() == 1);
  CHECK(friends.assignments.matched() == 1);
  CHECK(friends.talk());
  CHECK_FALSE(reader.take(sample));
}

}  // namespace

TEST_CASE("processes with the keys of a run hear each other", "[security]") {
  const Scene scene;
  Friends friends(scene);
  CHECK(friends.talk());
  CHECK_THAT(scene.log.str(), !Contains("refused"));
}

TEST_CASE("a participant without keys is shut out and named", "[security]") {
  const Scene scene;
  Friends friends(scene);
  bus::BusOptions writing = scene.place;
  writing.process = "stranger";
  bus::BusOptions reading = scene.place;
  reading.run += ".other";  // the two must not talk to each other
  SECTION("one that writes") {
    check_shut_out(friends, writing, reading);
  }
  SECTION("one that reads") {
    std::swap(writing.run, reading.run);
    check_shut_out(friends, writing, reading);
  }
  CHECK_THAT(scene.log.str(), Contains("refused a participant: 'stranger' at 127.0.0.1 shows no certificate"));
}

TEST_CASE("a participant of another authority is shut out and named", "[security]") {
  const Scene scene;
  Friends friends(scene);
  const fs::path foreign = scene.scratch / "foreign";
  const fs::path third = scene.scratch / "third";  // so that the two do not talk to each other
  for (const fs::path& dir : {foreign, third}) {
    bus::init_keys(dir, 10);
    for (const bus::Role role : {bus::Role::coordinator, bus::Role::environment})
      bus::issue_keys(dir, {.role = role, .name = "foreign"}, dir);
  }
  check_shut_out(friends, scene.as(bus::Role::coordinator, foreign, "foreign-writer"),
                 scene.as(bus::Role::environment, third, "foreign-reader"));
  for (const char* name : {"foreign-writer", "foreign-reader"})
    CHECK_THAT(scene.log.str(),
               Contains(std::string("refused a participant: '") + name + "' at 127.0.0.1 shows a certificate"));
}

TEST_CASE("a process cannot even open a topic that is not of its role", "[security]") {
  const Scene scene;
  const bus::Participant agent(scene.as(bus::Role::learning_agent));
  CHECK_THROWS_WITH(bus::Writer<wire::TrialAssignment>(agent),
                    Contains("TrialAssignment") && Contains("learning-agent"));
  CHECK_THROWS_WITH(bus::Reader<wire::TrialAssignment>(agent),
                    Contains("TrialAssignment") && Contains("learning-agent"));
}

TEST_CASE("an agent that opens a coordinator's topic all the same is refused by the others and named", "[security]") {
  const Scene scene;
  Friends friends(scene);
  // Its own middleware looks at the topic alone, the others' at the domain too. So permissions for another domain stand
  // for a program whose middleware has been tampered with.
  const fs::path keys = scene.scratch / "agent";
  bus::issue_keys(scene.keys, {.role = bus::Role::learning_agent, .name = "mallory"}, keys);
  std::string text = bus::permissions_xml({.role = bus::Role::learning_agent, .name = "mallory"},
                                          "CN=mallory,OU=learning-agent,O=Aloft");
  const std::string everywhere = "<id_range><min>0</min><max>101</max></id_range>";
  text.replace(text.find(everywhere), everywhere.size(), "<id>" + std::to_string(scene.place.domain) + "</id>");
  const std::string topics =
      "<topics><topic>TrialAssignment</topic></topics><partitions><partition>aloft/*</partition></partitions>";
  text.insert(text.find("<default>"), "<allow_rule><domains><id>101</id></domains><publish>" + topics +
                                          "</publish><subscribe>" + topics + "</subscribe></allow_rule>");
  test::write_text(keys / "learning-agent" / "permissions.p7s", bus::sign_document(scene.keys, text));

  bus::BusOptions writing = scene.as(bus::Role::learning_agent, keys, "mallory");
  bus::BusOptions reading = writing;
  SECTION("writing") {
    reading.run += ".other";
  }
  SECTION("reading") {
    writing.run += ".other";
  }
  check_shut_out(friends, writing, reading);
  CHECK_THAT(scene.log.str(), Contains("mallory") && Contains("TrialAssignment"));
}
