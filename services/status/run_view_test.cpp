#include "services/status/run_view.hpp"

#include <catch2/catch.hpp>
#include <sstream>

#include "common/base/text_layout.hpp"

using namespace aloft;
using namespace std::chrono_literals;
using Catch::Contains;

namespace {

const status::Clock::time_point start{};

wire::WorkerStatus worker_news(std::uint64_t flights, std::uint64_t steps) {
  wire::WorkerStatus news;
  news.worker("w0");
  news.experiment_id("0123456789abcdef");
  news.host("alpha");
  news.pid(17);
  news.incarnation(1);
  news.capacity(3);
  news.leases({0xab, 0xcd});
  news.flights_done(flights);
  news.steps_done(steps);
  news.answer_counts()[1] = 98;  // up to 50 us
  news.answer_counts()[8] = 2;   // up to 10 ms
  wire::AgentNews agent;
  agent.agent("dqn");
  agent.type("dqn");
  agent.process("aloft-learning-agent");
  agent.state(wire::AGENT_FLYING);
  agent.flights(5);
  agent.silent_s(0.25);
  news.agents().push_back(agent);
  agent.agent("planner");
  agent.state(wire::AGENT_SHADOW);
  news.agents().push_back(agent);
  agent.agent("min-height");
  agent.silent_s(12.0);
  news.agents().push_back(agent);
  return news;
}

wire::RunStatus run_news() {
  wire::RunStatus news;
  news.experiment_id("0123456789abcdef");
  news.state(wire::RUN_RUNNING);
  news.flights_total(100);
  news.flights_stored(40);
  news.flights_per_s(1.5);
  news.steps_per_s(150.0);
  news.trials_done(4);
  news.workers_alive(1);
  return news;
}

}  // namespace

TEST_CASE("a run is shown with the rates of its workers, the time left, and its agents", "[status]") {
  status::RunView view("demo");
  CHECK_FALSE(view.heard());
  view.hear(run_news(), start + 4s);
  view.hear(worker_news(10, 1000), start);
  view.hear(worker_news(16, 1600), start + 4s);
  CHECK(view.heard());
  CHECK_FALSE(view.complete());
  view.hear(wire::CollectorStatus(), start);
  view.on_middleware({"Fast DDS 2.9.1", "Fast DDS 3.1.2"});
  CHECK(view.complete());

  const auto json = view.to_json(start + 4s);
  CHECK(json["run"] == "demo");
  CHECK(json["experiment_id"] == "0123456789abcdef");
  CHECK(json["state"] == "running");
  CHECK(json["eta_s"] == 40.0);  // 60 flights at 1.5 per second
  CHECK(json["collector"]["state"] == "storing");
  const auto& worker = json["workers"][0];
  CHECK(worker["state"] == "alive");
  CHECK(worker["flights_per_s"] == 1.5);  // 6 in 4 s
  CHECK(worker["steps_per_s"] == 150.0);  // 600 in 4 s
  CHECK(worker["answer_p50_ms"].get<double>() == Approx(0.05));
  CHECK(worker["answer_p99_ms"] == 10.0);
  CHECK(worker["leases"] == nlohmann::json({"00000000000000ab", "00000000000000cd"}));
  CHECK(worker["agents"][0]["state"] == "flying");
  CHECK(worker["agents"][1]["state"] == "shadow");
  CHECK(worker["agents"][2]["state"] == "lost");
  CHECK(worker["agents"][2]["silent_s"] == 12.0);
  CHECK_THAT(status::run_text(json, unlimited_width),
             Contains("w0 flies: dqn flying, planner shadow, LOST for 0:12: min-height (aloft-learning-agent)"));
  CHECK_THAT(status::run_text(json, unlimited_width), Contains("\n  middleware: Fast DDS 2.9.1, Fast DDS 3.1.2\n"));
  CHECK(json["middleware"] == nlohmann::json({"Fast DDS 2.9.1", "Fast DDS 3.1.2"}));
  CHECK(status::run_line(json) == "demo: running  40/100 flights  1.5 flights/s  ETA 0:40  workers 1");
}

TEST_CASE("silent processes are named, with the time since they were heard", "[status]") {
  status::RunView view("demo");
  view.hear(run_news(), start);
  view.hear(worker_news(0, 0), start);
  auto json = view.to_json(start + 65s);
  CHECK(json["workers"][0]["state"] == "lost");
  CHECK(json["workers"][0]["agents"][0]["state"] == "lost");
  CHECK_THAT(status::run_text(json, unlimited_width),
             Contains("LOST 1:05") && !Contains("LOST for") && Contains("the coordinator has been silent for 1:05"));

  view.forget_old(start + 9min);
  CHECK(view.to_json(start)["workers"].size() == 1);
  view.forget_old(start + 11min);
  CHECK(view.to_json(start)["workers"].empty());

  auto leaving = worker_news(0, 0);
  leaving.capacity(0);
  view.hear(leaving, start);
  CHECK(view.to_json(start + 5s)["workers"][0]["state"] == "left");
  view.forget_old(start + 11s);
  CHECK(view.to_json(start)["workers"].empty());
}

TEST_CASE("the time left is unknown while nothing is stored", "[status]") {
  status::RunView view("demo");
  view.hear(run_news(), start);
  CHECK(view.to_json(start + 1s)["eta_s"] == 40.0);
  auto waiting = run_news();
  waiting.message("no worker for 5 s; waiting for one to join");
  view.hear(waiting, start + 3s);
  CHECK(view.to_json(start + 3s)["eta_s"].is_null());
  CHECK_THAT(status::run_line(view.to_json(start + 3s)), Contains("ETA -:--"));
  waiting.flights_stored(41);
  view.hear(waiting, start + 4s);
  CHECK(view.to_json(start + 4s)["eta_s"] == 39.0);
}

TEST_CASE("a run fits a narrow terminal, and a lost worker is one line", "[status]") {
  status::RunView view("a-run-with-a-name-that-is-rather-long-for-a-terminal");
  auto news = run_news();
  news.message("no worker has been heard for a while, so everything that is there waits until one joins this run");
  view.hear(news, start);
  view.hear(worker_news(10, 1000), start);
  const std::string alive = status::run_text(view.to_json(start + 1s), 60);
  INFO(alive);
  std::istringstream lines(alive);
  for (std::string line; std::getline(lines, line);) CHECK(display_width(line) <= 60);
  const std::string lost = status::run_text(view.to_json(start + 20s), 60);
  std::size_t about_it = 0;
  std::istringstream lost_lines(lost);
  for (std::string line; std::getline(lost_lines, line);) about_it += line.find("w0") != std::string::npos ? 1U : 0U;
  CHECK(about_it == 1);
}

TEST_CASE("a worker that restarted counts its rates anew", "[status]") {
  status::RunView view("demo");
  view.hear(worker_news(1000, 100000), start);
  auto again = worker_news(2, 200);
  again.incarnation(2);
  view.hear(again, start + 1s);
  again.steps_done(300);
  view.hear(again, start + 2s);
  CHECK(view.to_json(start + 2s)["workers"][0]["steps_per_s"] == 100.0);
}

TEST_CASE("messages cannot command the terminal", "[status]") {
  status::RunView view("demo");
  auto news = run_news();
  news.message("trial 3 failed\n\033[2Jtrial 4 failed");
  view.hear(news, start);
  CHECK_THAT(status::run_text(view.to_json(start), unlimited_width),
             Contains("! trial 3 failed; \\x1b[2Jtrial 4 failed\n"));
}

TEST_CASE("what cannot be read of an experiment is left out", "[status]") {
  status::RunView view("demo");
  wire::RunControl control;
  for (const std::string& text : {std::string(R"({"name": 5})"), std::string("[1]"), std::string("{"), std::string(),
                                  std::string(200'000, '['), std::string("\"\xff\"")}) {
    control.experiment_json(wire::bytes(text));
    view.hear(control, start);
    CHECK(view.to_json(start)["experiment"] == "");
  }
  control.experiment_json(wire::bytes(R"({"name": "the-one"})"));
  view.hear(control, start);
  CHECK(view.to_json(start)["experiment"] == "the-one");
}

TEST_CASE("times are written as on a clock", "[status]") {
  CHECK(status::clock_text(74.2) == "1:15");
  CHECK(status::clock_text(3700) == "1:01:40");
}
