// A run over two hosts: two network namespaces with a cable between them. Needs root.
#include <unistd.h>

#include <catch2/catch.hpp>
#include <cstdlib>
#include <thread>

#include "tests/deploy/scene.hpp"
#include "tests/skip.hpp"

using namespace aloft::test;
using namespace std::chrono_literals;

namespace {

constexpr const char* ip_program = "/usr/sbin/ip";

/// Hosts "a" (10.77.0.1) and "b" (10.77.0.2).
class TwoHosts {
 public:
  TwoHosts() {
    ip("netns add " + a_);
    ip("netns add " + b_);
    ip("-n " + a_ + " link add cable type veth peer name cable netns " + b_);
    for (const auto& [host, address] : {std::pair{a_, "10.77.0.1/24"}, std::pair{b_, "10.77.0.2/24"}}) {
      ip("-n " + host + " address add " + address + " dev cable");
      ip("-n " + host + " link set lo up");
      ip("-n " + host + " link set cable up");
    }
  }
  ~TwoHosts() {
    for (const std::string& host : {a_, b_})
      static_cast<void>(std::system((std::string(ip_program) + " netns delete " + host).c_str()));
  }
  TwoHosts(const TwoHosts&) = delete;
  TwoHosts& operator=(const TwoHosts&) = delete;

  [[nodiscard]] std::vector<std::string> on_a() const { return {ip_program, "netns", "exec", a_}; }
  [[nodiscard]] std::vector<std::string> on_b() const { return {ip_program, "netns", "exec", b_}; }
  void cut() const { ip("-n " + b_ + " link set cable down"); }
  void mend() const { ip("-n " + b_ + " link set cable up"); }

 private:
  static void ip(const std::string& arguments) {
    INFO(arguments);
    REQUIRE(std::system((std::string(ip_program) + " " + arguments).c_str()) == 0);
  }

  std::string a_ = "aloft-a-" + std::to_string(getpid());
  std::string b_ = "aloft-b-" + std::to_string(getpid());
};

bool may_make_namespaces() {
  const std::string probe = "aloft-probe-" + std::to_string(getpid());
  const std::string command =
      std::string(ip_program) + " netns add " + probe + " && " + ip_program + " netns delete " + probe;
  if (std::system(command.c_str()) == 0) return true;
  skip("this user may not make network namespaces here: run as root");
  return false;
}

/// One worker beside the coordinator, one on the other host; the cable is cut for a while.
void fly_through_partition(std::chrono::milliseconds partition, int trials, const std::vector<std::string>& on_a,
                           const std::vector<std::string>& on_b) {
  SpreadRun run(trials);
  const TwoHosts hosts;
  std::vector<std::string> here{"--workers", "1"};
  here.insert(here.end(), on_a.begin(), on_a.end());
  const auto main = run.start("run", here, hosts.on_a());
  std::vector<std::string> there{"--name", "far", "--log-dir", run.scratch("far").string()};
  there.insert(there.end(), on_b.begin(), on_b.end());
  const auto far = run.start("worker", there, hosts.on_b());
  INFO(far->error_so_far());
  REQUIRE(
      comes_true([&] { return run.log("aloft-coordinator").find("worker far is here") != std::string::npos; }, 30s));
  std::this_thread::sleep_for(1s);

  hosts.cut();
  if (partition >= 5s) {
    // Both sides report the missing peer.
    CHECK(comes_true(
        [&] { return run.log("aloft-coordinator").find("worker far has been silent") != std::string::npos; }, 5s));
    CHECK(comes_true([&] { return far->error_so_far().find("no coordinator of run") != std::string::npos; }, 5s));
  }
  std::this_thread::sleep_for(partition);
  hosts.mend();

  const Finished finished = main->wait(300s);
  INFO(finished.err);
  CHECK(finished.exit_code == 0);
  const Finished other = far->wait(30s);
  INFO(other.err);
  CHECK(other.exit_code == 0);
  CHECK(run.digest() == run.expected_digest());
}

const std::vector<std::string> server_a{"--interface", "10.77.0.1", "--discovery-server", "10.77.0.1:11811"};
const std::vector<std::string> server_b{"--interface", "cable", "--discovery-server", "10.77.0.1:11811"};

}  // namespace

TEST_CASE("a discovery server joins two hosts, and a second of partition changes nothing", "[needs-namespaces]") {
  if (may_make_namespaces()) fly_through_partition(1s, 60, server_a, server_b);
}

TEST_CASE("multicast joins two hosts on one network", "[needs-namespaces]") {
  if (may_make_namespaces()) fly_through_partition(0s, 60, {"--interface", "cable"}, {"--interface", "cable"});
}

TEST_CASE("after a partition of 5 s or 30 s, which both sides report, the run goes on", "[.][soak][needs-namespaces]") {
  if (!may_make_namespaces()) return;
  fly_through_partition(5s, 150, server_a, server_b);
  fly_through_partition(30s, 500, server_a, server_b);
  fly_through_partition(5s, 150, {"--interface", "cable"}, {"--interface", "cable"});
}
