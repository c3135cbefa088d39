// Keys that must be refused.
#include "common/security/keys.hpp"

#include <unistd.h>

#include <catch2/catch.hpp>
#include <filesystem>

#include "common/base/error.hpp"
#include "tests/integration/command.hpp"

using namespace aloft;
using namespace aloft::security;
using Catch::Contains;
namespace fs = std::filesystem;

namespace {

const TopicRights topics{.writes = {"WorkerStatus"}, .reads = {"RunControl"}};

/// An authority with one identity.
struct Scene {
  test::ScratchDir scratch;
  fs::path dir = scratch / "keys";

  Scene() {
    init_keys(dir, 100);
    issue(Role::channel);
  }
  void issue(Role role, int days = 10, int first_day = 0) const {
    issue_keys(dir, {.role = role, .name = "alpha", .days = days, .first_day = first_day}, topics, dir);
  }
  [[nodiscard]] std::string refusal(Role role = Role::channel) const {
    try {
      (void)check_keys(dir, role);
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  }
};

}  // namespace

TEST_CASE("good keys are accepted, also from the folder for another host", "[keys]") {
  const Scene scene;
  CHECK(scene.refusal() == "");
  issue_keys(scene.dir, {.role = Role::metrics, .name = "beta"}, topics, scene.scratch / "beta");
  CHECK_NOTHROW(check_keys(scene.scratch / "beta", Role::metrics));
  CHECK_FALSE(fs::exists(scene.scratch / "beta" / "ca.key.pem"));
  for (const char* file : {"ca.key.pem", "channel/key.pem"})
    CHECK((fs::status(scene.dir / file).permissions() & fs::perms::all) ==
          (fs::perms::owner_read | fs::perms::owner_write));
}

TEST_CASE("keys that are missing, open, old, of another role or altered are refused with the file and the remedy",
          "[keys]") {
  const Scene scene;
  const auto file = [&](const char* name) { return scene.dir / "channel" / name; };
  const std::string reissue = "aloft keys issue " + scene.dir.string() + " channel";
  SECTION("no folder") {
    CHECK_THROWS_WITH(check_keys("/nonexistent/keys", Role::channel),
                      Contains("--secure /nonexistent/keys: there is no such folder") && Contains("aloft keys init"));
  }
  SECTION("no identity of this role") {
    CHECK_THAT(scene.refusal(Role::metrics), Contains("metrics/cert.pem: is missing") && Contains("keys issue"));
  }
  SECTION("a missing file each") {
    for (const char* name : {"cert.pem", "key.pem", "permissions.p7s"}) {
      scene.issue(Role::channel);
      fs::remove(file(name));
      CHECK_THAT(scene.refusal(), Contains(file(name).string() + ": is missing") && Contains(reissue));
    }
    scene.issue(Role::channel);
    fs::remove(scene.dir / "governance.p7s");
    CHECK_THAT(scene.refusal(), Contains("governance.p7s: is missing"));
  }
  SECTION("a private key that others may read") {
    for (const fs::perms open : {fs::perms::group_read, fs::perms::others_read, fs::perms::others_write}) {
      fs::permissions(file("key.pem"), fs::perms::owner_read | fs::perms::owner_write | open);
      CHECK_THAT(scene.refusal(), Contains("key.pem: other users can read this private key") && Contains("chmod 600"));
    }
  }
  SECTION("expired") {
    scene.issue(Role::channel, 5, -10);
    CHECK_THAT(scene.refusal(), Contains("cert.pem: expired at 20") && Contains(reissue));
  }
  SECTION("permissions that expired before the certificate") {
    issue_keys(scene.dir, {.role = Role::channel, .name = "alpha", .days = 5, .first_day = -10}, topics,
               scene.scratch / "old");
    fs::copy_file(scene.scratch / "old" / "channel" / "permissions.p7s", file("permissions.p7s"),
                  fs::copy_options::overwrite_existing);
    CHECK_THAT(scene.refusal(), Contains("permissions.p7s: expired at 20") && Contains(reissue));
  }
  SECTION("not yet valid") {
    scene.issue(Role::channel, 10, 2);
    CHECK_THAT(scene.refusal(), Contains("cert.pem: is not valid before 20") && Contains("clock"));
  }
  SECTION("of another role") {
    scene.issue(Role::learning_agent);
    fs::remove_all(scene.dir / "channel");
    fs::rename(scene.dir / "learning-agent", scene.dir / "channel");
    CHECK_THAT(scene.refusal(), Contains("is for the role 'learning-agent', but this process is 'channel'"));
  }
  SECTION("of another authority") {
    init_keys(scene.scratch / "foreign", 10);
    issue_keys(scene.scratch / "foreign", {.role = Role::channel, .name = "alpha"}, topics, scene.scratch / "foreign");
    fs::remove_all(scene.dir / "channel");
    fs::rename(scene.scratch / "foreign" / "channel", scene.dir / "channel");
    CHECK_THAT(scene.refusal(), Contains("cert.pem: was not issued by the authority"));
  }
  SECTION("the key or the permissions of another process") {
    issue_keys(scene.dir, {.role = Role::channel, .name = "beta"}, topics, scene.scratch / "beta");
    const fs::path other = scene.scratch / "beta" / "channel";
    fs::copy_file(other / "permissions.p7s", file("permissions.p7s"), fs::copy_options::overwrite_existing);
    CHECK_THAT(scene.refusal(), Contains("permissions.p7s: is for another certificate"));
    fs::copy_file(other / "key.pem", file("key.pem"), fs::copy_options::overwrite_existing);
    CHECK_THAT(scene.refusal(), Contains("key.pem: does not belong to cert.pem"));
  }
  SECTION("permissions that were edited") {
    std::string text = test::read_text(file("permissions.p7s"));
    const std::size_t at = text.find("<topic>WorkerStatus</topic>");
    REQUIRE(at != std::string::npos);
    text.replace(at, 27, "<topic>RunControl</topic>");
    test::write_text(file("permissions.p7s"), text);
    CHECK_THAT(scene.refusal(),
               Contains("permissions.p7s: was not signed by the authority in ca.cert.pem, or was altered"));
  }
  SECTION("another governance, though signed") {
    std::string text = governance_xml();
    const std::size_t at = text.find("<metadata_protection_kind>ENCRYPT");
    REQUIRE(at != std::string::npos);
    text.replace(at, 33, "<metadata_protection_kind>NONE");
    test::write_text(scene.dir / "governance.p7s", sign_document(scene.dir, text));
    CHECK_THAT(scene.refusal(), Contains("governance.p7s: was made by another version of Aloft") && Contains(reissue));
    scene.issue(Role::channel);
    CHECK(scene.refusal() == "");
  }
  SECTION("files of another kind") {
    test::write_text(file("cert.pem"), "hello");
    CHECK_THAT(scene.refusal(), Contains("cert.pem: is not a certificate"));
  }
}

TEST_CASE("an authority is made once, and is needed to issue", "[keys]") {
  const Scene scene;
  CHECK_THROWS_WITH(init_keys(scene.dir, 10), Contains("holds an authority already"));
  fs::remove(scene.dir / "ca.key.pem");
  CHECK_THROWS_WITH(issue_keys(scene.dir, {.role = Role::metrics, .name = "m"}, topics, scene.dir),
                    Contains("ca.key.pem") && Contains("aloft keys init"));
}
