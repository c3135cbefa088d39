// What a role may do.
#include <algorithm>
#include <catch2/catch.hpp>

#include "common/bus/topics.hpp"

using namespace aloft;
using namespace aloft::bus;
using Catch::Contains;
using security::all_roles;
using security::permissions_xml;
using security::role_from_text;

TEST_CASE("every topic names the roles that write and read it", "[permissions]") {
  CHECK(all_topics().size() >= 15);
  for (const TopicSettings* topic : all_topics()) {
    INFO(topic->name);
    CHECK(topic->writers.bits != 0);
    CHECK(topic->readers.bits != 0);
  }
  // The roles that steer a run, and those that fly.
  for (const Role role : all_roles) {
    INFO(to_text(role));
    CHECK(topic_settings<wire::TrialAssignment>().writers.contain(role) == (role == Role::coordinator));
    CHECK(topic_settings<wire::RunControl>().writers.contain(role) == (role == Role::coordinator));
    CHECK(topic_settings<wire::SwapRequest>().writers.contain(role) == (role == Role::run_operator));
    CHECK(topic_settings<wire::EpisodeStored>().writers.contain(role) == (role == Role::metrics));
    CHECK(topic_settings<wire::HeightCommand>().writers.contain(role) ==
          (role == Role::learning_agent || role == Role::baseline_agent));
    CHECK(topic_settings<wire::SiteMap>().readers.contain(role) == (role == Role::baseline_agent));
    CHECK(topic_settings<wire::HeightProfile>().readers.contain(role) == (role == Role::baseline_agent));
    CHECK(role_from_text(to_text(role)) == role);
  }
  CHECK_THROWS_WITH(role_from_text("pilot"), Contains("'pilot'") && Contains("learning-agent"));
}

TEST_CASE("an observer reads how runs go and what is flown, but not the future, and writes nothing", "[permissions]") {
  security::TopicRights rights = topic_rights(Role::observer);
  std::ranges::sort(rights.reads);
  CHECK(rights.writes.empty());
  CHECK(rights.reads == decltype(rights.reads){"ChannelReport", "CollectorStatus", "HeightCommand", "RunControl",
                                               "RunStatus", "WorkerStatus"});
}

TEST_CASE("the permissions of a role are its rights in the table of topics", "[permissions]") {
  const std::string text = permissions_xml({.role = Role::environment, .name = "x"}, topic_rights(Role::environment),
                                           "CN=x,OU=environment,O=Aloft");
  CHECK_THAT(text, Contains("<subject_name>CN=x,OU=environment,O=Aloft</subject_name>"));
  const std::string writes = text.substr(text.find("<publish>"), text.find("</publish>") - text.find("<publish>"));
  const std::string reads = text.substr(text.find("<subscribe>"));
  CHECK_THAT(writes, Contains("<topic>World</topic>") && !Contains("RunControl"));
  CHECK_THAT(reads, Contains("<topic>RunControl</topic>") && Contains("<topic>TrialAssignment</topic>") &&
                        !Contains("<topic>World</topic>") && Contains("<default>DENY</default>"));
  CHECK_THAT(permissions_xml({.role = Role::observer, .name = "x"}, topic_rights(Role::observer), "CN=x"),
             !Contains("<publish>"));
  const std::string orders =
      permissions_xml({.role = Role::run_operator, .name = "x"}, topic_rights(Role::run_operator), "CN=x");
  CHECK_THAT(orders, Contains("<topics>\n            <topic>SwapRequest</topic>\n          </topics>"));
}
