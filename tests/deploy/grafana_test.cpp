// deploy/grafana: Debian's Prometheus watches a real run through these files.
#include <httplib.h>
#include <unistd.h>

#include <catch2/catch.hpp>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <regex>
#include <set>

#include "tests/deploy/scene.hpp"
#include "tests/skip.hpp"

using namespace aloft::test;
using namespace std::chrono_literals;
using nlohmann::json;

namespace {

const std::filesystem::path folder = "deploy/grafana";

bool there_is(const std::string& program) {
  return std::filesystem::exists("/usr/bin/" + program);
}

std::string replaced(const std::string& text, const std::string& what, const std::string& with) {
  return std::regex_replace(text, std::regex(what), with);
}

json dashboard() {
  return json::parse(read_text(folder / "dashboard.json"));
}

/// The expressions of the dashboard as Grafana would ask them for all collectors.
std::vector<std::string> dashboard_expressions() {
  std::vector<std::string> expressions;
  const json board = dashboard();
  for (const json& panel : board["panels"])
    for (const json& target : panel["targets"])
      expressions.push_back(replaced(replaced(target["expr"], R"(\$__rate_interval)", "5s"), R"(\$instance)", ".*"));
  return expressions;
}

/// What the rules compare: an alert itself has no data as long as all is well.
std::vector<std::string> compared_by_rules() {
  const std::string rules = read_text(folder / "aloft_rules.yml");
  const std::regex rule(R"(\n +expr: (.+) [<>] [0-9.]+\n)");
  std::vector<std::string> expressions;
  for (std::sregex_iterator found(rules.begin(), rules.end(), rule), end; found != end; ++found)
    expressions.push_back(replaced((*found)[1], R"(\[[0-9]+m\])", "[5s]"));
  const std::regex any_rule("- alert:");
  const auto count = std::distance(std::sregex_iterator(rules.begin(), rules.end(), any_rule), std::sregex_iterator());
  REQUIRE(static_cast<std::size_t>(count) == expressions.size());
  return expressions;
}

/// The port in "http://127.0.0.1:PORT/" of the collector's log.
int port_of_metrics(const SpreadRun& run) {
  std::smatch found;
  std::string log;
  REQUIRE(comes_true(
      [&] {
        log = run.log("aloft-metrics");
        return std::regex_search(log, found, std::regex("http://127.0.0.1:([0-9]+)/"));
      },
      30s));
  return std::stoi(found[1]);
}

/// Prometheus with the configuration of deploy/grafana, but for the collector's port and the intervals.
class Prometheus {
 public:
  Prometheus(const SpreadRun& run, int metrics_port) : port_(12000 + getpid() % 20000) {
    std::string configuration = read_text(folder / "prometheus.yml");
    configuration = replaced(configuration, "127.0.0.1:9464", "127.0.0.1:" + std::to_string(metrics_port));
    configuration = replaced(configuration, "interval: 5s", "interval: 1s");
    const auto file = run.scratch("prometheus.yml");
    write_text(file, configuration);
    std::filesystem::copy(folder / "aloft_rules.yml", run.scratch("aloft_rules.yml"));
    process_ = std::make_unique<Command>(std::vector<std::string>{
        "/usr/bin/prometheus", "--config.file=" + file.string(), "--storage.tsdb.path=" + run.scratch("tsdb").string(),
        "--web.listen-address=127.0.0.1:" + std::to_string(port_)});
  }

  /// The "data" of its answer; null if it gives none.
  [[nodiscard]] json ask(const std::string& path, const httplib::Params& parameters = {}) const {
    httplib::Client client("127.0.0.1", port_);
    client.set_connection_timeout(1);
    client.set_read_timeout(5);
    const auto answer = client.Get(path, parameters, httplib::Headers{});
    if (!answer || answer->status != 200) return nullptr;
    return json::parse(answer->body)["data"];
  }
  /// The values of an expression now, without those that are no numbers.
  [[nodiscard]] std::size_t values(const std::string& expression) const {
    const json data = ask("/api/v1/query", {{"query", expression}});
    std::size_t count = 0;
    if (data.is_object())
      for (const json& row : data["result"]) count += row["value"][1] == "NaN" ? 0 : 1;
    return count;
  }
  [[nodiscard]] std::string error_so_far() const { return process_->error_so_far(); }

 private:
  int port_;
  std::unique_ptr<Command> process_;
};

}  // namespace

TEST_CASE("Prometheus has data of a run for every expression of the dashboard and the rules", "[needs-prometheus]") {
  if (!there_is("prometheus")) return skip("there is no Prometheus");
  const SpreadRun run(400);
  const auto metrics = run.metrics({"--http-port", "0"});
  const Prometheus prometheus(run, port_of_metrics(run));
  const auto coordinator = run.coordinator();
  const auto worker = run.worker("w0");

  std::vector<std::string> expressions = dashboard_expressions();
  const std::vector<std::string> rules = compared_by_rules();
  expressions.insert(expressions.end(), rules.begin(), rules.end());
  CHECK(expressions.size() > 15);
  for (const std::string& expression : expressions) {
    INFO(expression << "\n" << prometheus.error_so_far());
    CHECK(comes_true([&] { return prometheus.values(expression) > 0; }, 30s));
  }
  CHECK(prometheus.values("aloft_flights_total == 2400") == 1);  // 400 trials, 2 conditions, 3 agents
  CHECK(prometheus.values("no_such_metric") == 0);
  CHECK(coordinator->running());
  const json groups = prometheus.ask("/api/v1/rules")["groups"];
  REQUIRE(groups.size() == 1);
  for (const json& rule : groups[0]["rules"]) {
    INFO(rule.dump());
    CHECK(rule["health"] == "ok");
    CHECK(rule["state"] != "firing");
  }
}

TEST_CASE("promtool accepts the configuration and the rules, and its tests of the rules pass", "[needs-prometheus]") {
  if (!there_is("promtool")) return skip("there is no promtool");
  const auto check = [](const std::vector<std::string>& arguments) {
    std::vector<std::string> command{"/usr/bin/promtool"};
    command.insert(command.end(), arguments.begin(), arguments.end());
    const Finished finished = run_command(command);
    INFO(finished.out << finished.err);
    CHECK(finished.exit_code == 0);
  };
  check({"check", "config", (folder / "prometheus.yml").string()});
  check({"test", "rules", (folder / "aloft_rules_test.yml").string()});
}

TEST_CASE("the panels of the dashboard lie side by side, and ask the chosen data source") {
  std::set<std::pair<int, int>> taken;
  std::set<int> ids;
  const json board = dashboard();
  for (const json& panel : board["panels"]) {
    INFO(panel["title"]);
    CHECK(ids.insert(panel["id"].get<int>()).second);
    const json& place = panel["gridPos"];
    CHECK(place["x"].get<int>() + place["w"].get<int>() <= 24);
    for (int x = place["x"]; x < place["x"].get<int>() + place["w"].get<int>(); ++x)
      for (int y = place["y"]; y < place["y"].get<int>() + place["h"].get<int>(); ++y)
        CHECK(taken.insert({x, y}).second);
    for (const json& target : panel["targets"]) CHECK(target["datasource"]["uid"] == "${datasource}");
  }
}
