// A run that is refused, by whichever process, leaves nothing behind: no folder, no empty database, no logs.
#include <fcntl.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <catch2/catch.hpp>
#include <map>

#include "tests/integration/command.hpp"

using namespace aloft::test;
using Catch::Contains;
namespace fs = std::filesystem;

namespace {

constexpr const char* experiment_text = R"({"name": "small", "seed": 3, "trials": 2,
  "world": {"kind": "generated", "bs_density_per_km2": [2.5, 5], "steps": 20}, "agents": ["min-height", "random-walk"]})";

/// Every path below `dir` with the content of the files, except SQLite's -wal and -shm, which come and go.
std::map<std::string, std::string> content_of(const fs::path& dir) {
  std::map<std::string, std::string> content;
  for (const auto& entry : fs::recursive_directory_iterator(dir)) {
    const std::string name = entry.path().filename().string();
    if (name.ends_with("-wal") || name.ends_with("-shm")) continue;
    content[entry.path().string()] = entry.is_regular_file() ? read_text(entry.path()) : "";
  }
  return content;
}

/// A UDP or TCP port that is occupied as long as this object lives.
class TakenPort {
 public:
  explicit TakenPort(int type) : socket_(socket(AF_INET, type | SOCK_CLOEXEC, 0)) {
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    socklen_t size = sizeof address;
    auto* generic = reinterpret_cast<sockaddr*>(&address);
    REQUIRE(bind(socket_, generic, size) == 0);
    REQUIRE(getsockname(socket_, generic, &size) == 0);
    port_ = std::to_string(ntohs(address.sin_port));
    if (type == SOCK_STREAM) REQUIRE(listen(socket_, 1) == 0);
  }
  ~TakenPort() { close(socket_); }
  TakenPort(const TakenPort&) = delete;
  TakenPort& operator=(const TakenPort&) = delete;
  [[nodiscard]] const std::string& port() const { return port_; }

 private:
  int socket_;
  std::string port_;
};

using Arguments = std::vector<std::string>;

Arguments operator+(Arguments a, const Arguments& b) {
  a.insert(a.end(), b.begin(), b.end());
  return a;
}

/// Why --secure is refused with a folder of keys that is not there.
constexpr const char* without_keys = ALOFT_SECURED_RUNS == 1 ? "no-keys" : "a run cannot be secured on Fast DDS";

/// A scratch folder with the experiment in it.
struct Scene {
  ScratchDir scratch;
  std::string experiment = (scratch / "experiment.json").string();
  std::string out = (scratch / "new" / "out").string();
  Scene() { write_text(experiment, experiment_text); }

  /// Checks that the command is refused with this exit code and changes no file.
  void check_refused(const Arguments& command, const std::string& why, int exit_code = 2) const {
    INFO(why);
    const auto before = content_of(scratch.path());
    const Finished finished = run_command(Arguments{"aloft"} + command);
    INFO(finished.err);
    CHECK(finished.exit_code == exit_code);
    CHECK_THAT(finished.err, Contains(why));
    CHECK(finished.out.empty());
    CHECK(content_of(scratch.path()) == before);
  }
};

}  // namespace

TEST_CASE("a refused run leaves no folder behind") {
  const Scene scene;
  const TakenPort server(SOCK_DGRAM);
  const Arguments run{"run", scene.experiment, "--out", scene.out};
  scene.check_refused(run + Arguments{"--interface", "no-such-interface"}, "no-such-interface");
  scene.check_refused(run + Arguments{"--interface", "192.0.2.1"}, "192.0.2.1");
  scene.check_refused(run + Arguments{"--discovery-server", "127.0.0.1:" + server.port()}, server.port());
  scene.check_refused(run + Arguments{"--discovery-server", "nobody.invalid:11811"}, "nobody.invalid");
  scene.check_refused(run + Arguments{"--secure", (scene.scratch / "no-keys").string()}, without_keys);
  scene.check_refused(run + Arguments{"--domain", "100000"}, "--domain");
  scene.check_refused(run + Arguments{"--in-process", "--workers", "0"}, "--workers");
  scene.check_refused(run + Arguments{"--agents", "min-hight"}, "min-height");
  const Arguments bad_bus{"--interface", "no-such-interface", "--out", scene.out};
  scene.check_refused(Arguments{"tournament", scene.experiment, "--trials", "2"} + bad_bus, "no-such-interface");
  scene.check_refused(Arguments{"reproduce", "--trials", "1"} + bad_bus, "no-such-interface");

  // A folder that was there already stays, as it was.
  fs::create_directories(scene.out);
  scene.check_refused(run + Arguments{"--interface", "no-such-interface"}, "no-such-interface");
  write_text(scene.out + "/letter.txt", "Dear all");
  scene.check_refused(run, "letter.txt");
  scene.check_refused(run + Arguments{"--in-process"}, "letter.txt");
  scene.check_refused({"run", scene.experiment, "--out", scene.out + "/letter.txt/below"}, "below");
}

TEST_CASE("a run that its results refuse leaves them as they were") {
  const Scene scene;
  const Arguments run{"run", scene.experiment, "--out", scene.out};
  REQUIRE(run_command(Arguments{"aloft"} + run + Arguments{"--in-process"}).exit_code == 0);
  for (const Arguments& how : {Arguments{}, Arguments{"--in-process"}}) {
    scene.check_refused(run + how + Arguments{"--seed", "4"}, "another experiment");
    if (how.empty()) scene.check_refused(run + how + Arguments{"--trials", "3"}, "trials");
  }
  const std::string database = scene.out + "/results.sqlite";
  const std::string intact = read_text(database);
  write_text(database, intact.substr(0, intact.size() / 2));
  for (const Arguments& how : {Arguments{}, Arguments{"--in-process"}})
    scene.check_refused(run + how, "results.sqlite' is damaged", 1);
  fs::remove(database);
  for (const Arguments& how : {Arguments{}, Arguments{"--in-process"}})
    scene.check_refused(run + how, "has lost its results.sqlite");
}

TEST_CASE("a service of a run that is refused leaves no folder behind") {
  const Scene scene;
  const TakenPort http(SOCK_STREAM);
  const Arguments where{scene.experiment, "--run", "refused", "--out", scene.out};
  for (const std::string service : {"metrics", "coordinator"}) {
    const Arguments command = Arguments{service} + where;
    scene.check_refused(command + Arguments{"--interface", "no-such-interface"}, "no-such-interface");
    scene.check_refused(command + Arguments{"--secure", (scene.scratch / "no-keys").string()}, without_keys);
  }
  scene.check_refused(Arguments{"metrics"} + where + Arguments{"--http-port", http.port()}, http.port());
  scene.check_refused(Arguments{"metrics"} + where + Arguments{"--http-port", "0", "--http-address", "192.0.2.1"},
                      "192.0.2.1");
  scene.check_refused({"metrics", "--run", "refused", "--out", scene.out}, "experiment.json");
  scene.check_refused({"worker", "--join", "refused", "--interface", "no-such-interface", "--log-dir", scene.out},
                      "no-such-interface");
}
