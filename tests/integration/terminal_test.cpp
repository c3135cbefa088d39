// The output that a user sees in a terminal, captured through a pseudo terminal.
#include "tests/integration/terminal.hpp"

#include <signal.h>

#include <catch2/catch.hpp>
#include <regex>

#include "tests/integration/command.hpp"
#include "tests/paths.hpp"

using aloft::test::bin_dir;
using aloft::test::read_text;
using aloft::test::run_command;
using aloft::test::ScratchDir;
using aloft::test::Screen;
using aloft::test::TerminalSession;
using aloft::test::test_domain;
using aloft::test::write_text;
using Catch::Contains;
using namespace std::chrono_literals;

namespace {

const std::string experiment_text = R"({
  "name": "terminal", "seed": 3, "trials": 40,
  "world": {"bs_density_per_km2": [1, 5], "steps": 60},
  "agents": ["min-height", "random-walk", {"type": "dqn", "name": "dqn-with-a-long-name", "epochs": 20}]
})";

/// Number of rows that show a status line.
std::size_t progress_rows(const Screen& screen) {
  static const std::regex progress(R"(^\d+/\d+ flights.*)");
  const std::vector<std::string> rows = screen.rows();
  return static_cast<std::size_t>(
      std::count_if(rows.begin(), rows.end(), [](const std::string& row) { return std::regex_match(row, progress); }));
}

/// Whether the last row shows the text within the time.
bool listen_until_row(TerminalSession& session, const std::string& text, std::chrono::milliseconds limit) {
  for (const auto until = std::chrono::steady_clock::now() + limit; std::chrono::steady_clock::now() < until;) {
    session.listen();
    if (session.screen().rows().back().find(text) != std::string::npos) return true;
  }
  return false;
}

}  // namespace

TEST_CASE("the screen of the test wraps, returns and erases as a terminal does", "[terminal]") {
  Screen screen(10);
  screen.write("12345678\r\n0123456789");
  CHECK(screen.wrapped_lines().empty());  // the last column may be used
  screen.write("ab");
  CHECK(screen.rows() == std::vector<std::string>{"12345678", "0123456789", "ab"});
  CHECK(screen.wrapped_lines() == std::vector<std::string>{"0123456789ab"});
  screen.write("\r\033");
  screen.write("[Kµ±\033[1mx\033[0m");
  CHECK(screen.rows().back() == "µ±x");
}

TEST_CASE(
    "the progress of a run takes one row, what is logged stands above it, and a run that waits tells no time left",
    "[terminal]") {
  const ScratchDir scratch;
  write_text(scratch / "experiment.json", experiment_text);
  const std::string out = (scratch / "out").string();
  TerminalSession session({"aloft", "run", (scratch / "experiment.json").string(), "--out", out, "--workers", "1",
                           "--domain", test_domain()},
                          60);
  const auto signal_to = [&](const std::string& program, int signal) {
    bool sent = false;
    for (const int pid : aloft::test::processes_with(out))
      if (read_text("/proc/" + std::to_string(pid) + "/cmdline").find(program) != std::string::npos)
        sent = kill(pid, signal) == 0;
    return sent;
  };
  const auto listen_until = [&](const std::string& text) {
    const auto limit = std::chrono::steady_clock::now() + 60s * aloft::test::slowdown;
    const std::size_t from = session.bytes().size();
    while (session.bytes().find(text, from) == std::string::npos && std::chrono::steady_clock::now() < limit)
      if (!session.listen()) return false;
    return session.bytes().find(text, from) != std::string::npos;
  };
  CHECK(listen_until("  ETA "));
  CHECK(signal_to("aloft-learning-agent", SIGKILL));
  CHECK(signal_to("aloft-metrics", SIGSTOP));
  CHECK(listen_until("nothing stored for"));
  CHECK_FALSE(listen_until_row(session, "ETA", 1s));
  CHECK(signal_to("aloft-metrics", SIGCONT));
  CHECK(session.wait(120s) == 0);

  INFO(session.bytes());
  CHECK(progress_rows(session.screen()) == 1);  // drawn many times, but only the last one stays
  const std::vector<std::string> rows = session.screen().rows();
  const auto row_with = [&](const std::string& text) {
    return std::find_if(rows.begin(), rows.end(),
                        [&](const std::string& row) { return row.find(text) != std::string::npos; });
  };
  CHECK(row_with("aloft-learning-agent-w0 was ended by signal 9") < row_with("240/240 flights"));
  CHECK(row_with("240/240 flights") < row_with("min-height"));
}

TEST_CASE("nothing wraps in terminals of 60, 80 and 200 columns", "[terminal]") {
  const ScratchDir scratch;
  write_text(scratch / "experiment.json", experiment_text);
  const std::string out = (scratch / "out").string();
  const std::vector<std::string> run{
      "aloft", "run", (scratch / "experiment.json").string(), "--in-process", "--trials", "3", "--out", out};
  const auto shown = [](const std::vector<std::string>& command, unsigned short columns) {
    INFO(command[1] << " in " << columns << " columns");
    TerminalSession session(command, columns);
    CHECK(session.wait(60s) == 0);
    INFO(session.bytes());
    for (const std::string& line : session.screen().wrapped_lines()) {
      INFO(line);
      CHECK(line.find(' ', line.find_first_not_of(' ')) == std::string::npos);  // one word, e.g. a SHA-256
    }
    CHECK(progress_rows(session.screen()) <= 1);
    std::string text;
    for (const std::string& row : session.screen().rows()) text += row + '\n';
    return text;
  };
  for (const unsigned short columns : std::initializer_list<unsigned short>{60, 80, 200}) {
    const bool wide = columns == 200;
    const std::string table = shown(run, columns);
    CHECK_THAT(table, Contains("dqn-with-a-long-name") && Contains("gain over min-height"));
    CHECK((table.find("[quartiles]") != std::string::npos && table.find("Left out") == std::string::npos) == wide);
    CHECK_THAT(shown({"aloft", "compare", out, out}, columns), Contains("random-walk") && Contains("B - A"));
    CHECK_THAT(shown({"aloft", "validate", "quick"}, columns), Contains("800 flights"));
    CHECK_THAT(shown({"aloft", "agents"}, columns), Contains("height-filter") && Contains("true or false"));
    const std::string tournament =
        shown({"aloft", "tournament", "--trials", "2", "--agents", "min-height,planner,local-bandit", "--in-process",
               "--out", (scratch / "tournament").string()},
              columns);
    CHECK_THAT(tournament, Contains("1 / 200") && Contains("head-room closed") && !Contains("|---|"));
  }
}

TEST_CASE("where the output goes to a file nothing is left out, unless COLUMNS asks for it", "[terminal]") {
  const ScratchDir scratch;
  write_text(scratch / "experiment.json", experiment_text);
  std::vector<std::string> run{bin_dir() / "aloft",
                               "run",
                               (scratch / "experiment.json").string(),
                               "--in-process",
                               "--trials",
                               "3",
                               "--out",
                               (scratch / "out").string()};
  const auto with = [&](std::vector<std::string> before, const std::vector<std::string>& after) {
    before.insert(before.begin(), "/usr/bin/env");
    before.insert(before.end(), run.begin(), run.end());
    before.insert(before.end(), after.begin(), after.end());
    return run_command(before).out;
  };
  const std::string all = with({"-u", "COLUMNS"}, {});
  CHECK_THAT(all, Contains("[quartiles]") && Contains("handovers"));
  CHECK_THAT(with({"COLUMNS=80"}, {}), !Contains("[quartiles]  ") && Contains("Left out to fit 80 columns: "));
  CHECK(with({"COLUMNS=80"}, {"--wide"}) == all);
  CHECK_THAT(with({"-u", "COLUMNS"}, {"--brief"}), !Contains("height m") && Contains("gain over min-height"));
  const std::string tournament =
      run_command({"/usr/bin/env", "-u", "COLUMNS", bin_dir() / "aloft", "tournament", "--trials", "2", "--agents",
                   "min-height,planner", "--in-process", "--out", (scratch / "tournament").string()})
          .out;
  CHECK_THAT(tournament, Contains("| agent | 1 / 200 | 2.5 / 200 |") && Contains("|---|---|"));
}

TEST_CASE("aloft agents tells about one, called as in an experiment", "[terminal]") {
  const std::string one = run_command({"aloft", "agents", "constant-120"}).out;
  CHECK_THAT(one, Catch::StartsWith("constant") && Contains("height_m (") && !Contains("local-bandit"));
  CHECK(run_command({"aloft", "agents", "constant"}).out == one);
  CHECK_THAT(run_command({"aloft", "agents", "--brief"}).out, Contains("local-bandit") && !Contains("height_m ("));
  const auto misspelt = run_command({"aloft", "agents", "dqm"});
  CHECK(misspelt.exit_code == 2);
  CHECK_THAT(misspelt.err, Contains("Did you mean 'dqn'?"));
}
