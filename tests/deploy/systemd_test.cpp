// The systemd units rely on this: processes report to the service manager that they are ready, alive and stopping.
#include <signal.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <array>
#include <catch2/catch.hpp>
#include <cstdlib>
#include <thread>

#include "tests/deploy/scene.hpp"
#include "tests/paths.hpp"
#include "tests/skip.hpp"

using namespace aloft::test;
using namespace std::chrono_literals;
using Catch::Contains;

namespace {

/// Plays the service manager.
class Manager {
 public:
  explicit Manager(const std::filesystem::path& path) : socket_(socket(AF_UNIX, SOCK_DGRAM | SOCK_NONBLOCK, 0)) {
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    path.string().copy(address.sun_path, sizeof address.sun_path - 1);
    REQUIRE(bind(socket_, reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0);  // NOLINT
  }
  ~Manager() { close(socket_); }
  Manager(const Manager&) = delete;
  Manager& operator=(const Manager&) = delete;

  /// All notifications so far, one per line.
  const std::string& heard() {
    std::array<char, 512> buffer{};
    for (ssize_t size = 0; (size = recv(socket_, buffer.data(), buffer.size(), 0)) > 0;)
      heard_ += std::string(buffer.data(), static_cast<std::size_t>(size)) + "\n";
    return heard_;
  }
  [[nodiscard]] std::size_t count(const std::string& word) {
    std::size_t times = 0;
    for (std::size_t at = heard().find(word); at != std::string::npos; at = heard_.find(word, at + 1)) ++times;
    return times;
  }

 private:
  int socket_;
  std::string heard_;
};

}  // namespace

TEST_CASE("coordinator, metrics and worker keep the service manager informed; a frozen one does not") {
  SpreadRun run(1000);
  const std::vector<std::string> programs{"metrics", "coordinator", "worker"};
  std::vector<std::unique_ptr<Manager>> managers;
  std::vector<std::unique_ptr<Command>> processes;
  for (const std::string& program : programs) {
    const std::string path = run.scratch(program + ".socket").string();
    managers.push_back(std::make_unique<Manager>(path));
    std::vector<std::string> more;
    if (program == "worker") more = {"--log-dir", run.scratch("log").string()};
    processes.push_back(run.start(
        program, more, {"/usr/bin/env", "-u", "WATCHDOG_PID", "NOTIFY_SOCKET=" + path, "WATCHDOG_USEC=400000"}));
  }
  for (std::size_t i = 0; i < programs.size(); ++i) {
    INFO(programs[i] << ": " << managers[i]->heard());
    CHECK(comes_true([&] { return managers[i]->count("READY=1") == 1 && managers[i]->count("WATCHDOG=1") > 3; }, 20s));
  }
  processes[0]->send(SIGSTOP);
  std::this_thread::sleep_for(100ms);  // a notification can still be on its way
  const std::size_t before = managers[0]->count("WATCHDOG=1");
  std::this_thread::sleep_for(1s);
  CHECK(managers[0]->count("WATCHDOG=1") == before);
  processes[0]->send(SIGCONT);
  for (const std::size_t i : {2U, 0U, 1U}) {
    INFO(programs[i]);
    CHECK(managers[i]->count("READY=1") == 1);  // reads the socket, which would refuse more when full
    processes[i]->send(SIGTERM);
    CHECK(comes_true([&] { return managers[i]->count("STOPPING=1") == 1 && !processes[i]->running(); }, 30s));
    CHECK(processes[i]->wait(15s).exit_code == 130);
    CHECK(managers[i]->count("STOPPING=1") == 1);
    CHECK(managers[i]->count("READY=1") == 1);  // its children send none
  }
}

TEST_CASE("systemd accepts the units", "[needs-systemd]") {
  if (!std::filesystem::exists("/usr/bin/systemd-analyze"))
    return skip("there is no systemd-analyze; install the package systemd");
  const ScratchDir scratch;
  std::vector<std::string> command{"/usr/bin/systemd-analyze", "verify", "--man=no"};
  for (const auto& unit : std::filesystem::directory_iterator(source_dir() / "deploy/systemd")) {
    if (unit.path().extension() != ".service") continue;
    std::string text = read_text(unit.path());
    for (std::size_t at = 0; (at = text.find("/usr/bin/aloft", at)) != std::string::npos; ++at)
      text.replace(at, std::string("/usr/bin").size(), bin_dir().string());
    std::string name = unit.path().filename().string();
    if (const std::size_t at = name.find("@."); at != std::string::npos) name.insert(at + 1, 1, '1');
    write_text(scratch / name, text);
    command.push_back((scratch / name).string());
    CHECK_THAT(text, Contains("Type=notify") && Contains("WatchdogSec=") && Contains("MemoryMax="));
  }
  REQUIRE(command.size() == 7);
  const Finished verified = run_command(command);
  CHECK(verified.exit_code == 0);
  CHECK(verified.err.empty());
}
