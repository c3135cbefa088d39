// The help as a user requests it, and its examples as a user would copy them.
#include <sched.h>

#include <catch2/catch.hpp>
#include <iterator>
#include <regex>
#include <sstream>

#include "common/base/text_layout.hpp"
#include "tests/integration/command.hpp"
#include "tests/paths.hpp"

using aloft::display_width;
using aloft::test::bin_dir;
using aloft::test::Finished;
using aloft::test::run_command;
using aloft::test::ScratchDir;
using Catch::Contains;

namespace {

std::vector<std::string> words_of(const std::string& text) {
  std::istringstream stream(text);
  return {std::istream_iterator<std::string>(stream), {}};
}

std::vector<std::string> lines_of(const std::string& text) {
  std::vector<std::string> lines;
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);) lines.push_back(line);
  return lines;
}

struct Page {
  std::string command;  ///< "keys init"
  std::string text;
  std::vector<std::string> commands;  ///< below it
  std::vector<std::string> examples;
};

Page page_of(const std::string& command, std::size_t columns) {
  static const std::regex entry("^  ([a-z-]+)( {2,}.*)?$");
  std::vector<std::string> arguments{"/usr/bin/env", "COLUMNS=" + std::to_string(columns), bin_dir() / "aloft", "help"};
  for (const std::string& word : words_of(command)) arguments.push_back(word);
  Page page{command, run_command(arguments).out, {}, {}};
  bool in_examples = false;
  for (const std::string& line : lines_of(page.text)) {
    std::smatch match;
    if (in_examples && !line.starts_with("  # ")) page.examples.push_back(line.substr(2));
    if (!in_examples && std::regex_match(line, match, entry) && !match.str(1).starts_with('-'))
      page.commands.push_back(command + (command.empty() ? "" : " ") + match.str(1));
    in_examples = in_examples || line.starts_with("Example");
  }
  return page;
}

/// The help of aloft and of all its commands.
std::vector<Page> all_pages(std::size_t columns) {
  std::vector<Page> pages{page_of("", columns)};
  for (std::size_t i = 0; i < pages.size(); ++i)
    for (const std::string& command : std::vector<std::string>(pages[i].commands))
      pages.push_back(page_of(command, columns));
  return pages;
}

/// A command line for the shell, as typed in `folder`.
Finished typed(const std::filesystem::path& folder, const std::string& line) {
  return run_command({"/usr/bin/env", "--chdir", folder.string(), "PATH=" + bin_dir().string() + ":/usr/bin:/bin",
                      "/bin/sh", "-c", line},
                     std::chrono::seconds(120));
}

}  // namespace

TEST_CASE("aloft alone lists the commands; help tells about one", "[help]") {
  const Finished alone = run_command({"aloft"});
  CHECK(alone.exit_code == 2);
  CHECK(alone.out.empty());
  const Finished help = run_command({"aloft", "help"});
  CHECK(help.exit_code == 0);
  CHECK(help.out == alone.err);
  CHECK(help.out == run_command({"aloft", "--help"}).out);
  for (const char* command : {"run", "validate", "tournament", "worker", "keys", "help"})
    CHECK_THAT(help.out, Contains("\n  " + std::string(command) + " "));
  CHECK(run_command({"aloft", "help", "run"}).out == run_command({"aloft", "run", "--help"}).out);
  CHECK(run_command({"aloft", "help", "keys", "issue"}).out == run_command({"aloft", "keys", "issue", "--help"}).out);
  const Finished misspelt = run_command({"aloft", "help", "rnu"});
  CHECK(misspelt.exit_code == 2);
  CHECK_THAT(misspelt.err, Contains("no command 'rnu'") && Contains("Did you mean 'run'?"));
}

TEST_CASE("help, of which the man pages are made, does not depend on the machine's number of cores", "[help]") {
  cpu_set_t cores;
  REQUIRE(sched_getaffinity(0, sizeof cores, &cores) == 0);
  int first = 0;
  while (!CPU_ISSET(first, &cores)) ++first;
  const auto on_one_core = [&](std::vector<std::string> command) {
    command.insert(command.begin(), {"/usr/bin/taskset", "--cpu-list", std::to_string(first)});
    return run_command(command).out;
  };
  for (const char* service : {"learning-agent", "baseline-agent", "environment", "channel", "coordinator", "metrics"}) {
    const std::string program = bin_dir() / ("aloft-" + std::string(service));
    CHECK(on_one_core({program, "--help"}) == run_command({program, "--help"}).out);
  }
  for (const Page& page : all_pages(80)) {
    std::vector<std::string> command{bin_dir() / "aloft", "help"};
    for (const std::string& word : words_of(page.command)) command.push_back(word);
    CHECK(on_one_core(command) == run_command(command).out);
  }
}

TEST_CASE("every command's help has examples that it takes, and says ranges in words", "[help]") {
  static const std::regex raw(R"(\bU?INT\b|\bFLOAT\b|TEXT:|REQUIRED|Excludes| in \[|\{[a-z]+,|\[\[|\[")");
  // With --help at its end, a command line is checked, except for missing options.
  REQUIRE(run_command({"aloft", "run", "quick", "--workers", "x", "--help"}).exit_code == 2);
  std::size_t commands = 0;
  for (const Page& page : all_pages(80)) {
    INFO(page.command);
    CHECK_THAT(page.text, Contains("Usage: aloft" + (page.command.empty() ? "" : " " + page.command)));
    for (const std::string& line : lines_of(page.text)) {
      INFO(line);
      CHECK_FALSE(std::regex_search(line, raw));
    }
    if (!page.commands.empty()) continue;
    ++commands;
    CHECK_FALSE(page.examples.empty());
    for (const std::string& example : page.examples) {
      INFO(example);
      CHECK(example.starts_with("aloft " + page.command));
      std::vector<std::string> words = words_of(example);
      for (const std::string& word : words) {
        const std::regex as_option("\n  (-h,)?" + word + "\\b");
        if (word.starts_with("--")) CHECK(std::regex_search(page.text, as_option));
      }
      words.emplace_back("--help");
      const Finished checked = run_command(words);
      CHECK(checked.exit_code == 0);
      CHECK_THAT(checked.out, Contains("Usage: aloft " + page.command));
      // The example has the arguments of the usage line.
      std::istringstream usage(page.text.substr(page.text.find("Usage:")));
      for (std::string wanted; usage >> wanted && wanted != "[OPTIONS]";)
        if (wanted.starts_with("--")) CHECK_THAT(example, Contains(wanted));
    }
  }
  CHECK(commands >= 22);
  CHECK_THAT(page_of("run", 80).text, Contains("(0 to 64)") && Contains("(text or json) [text]"));
}

TEST_CASE("help fits terminals of 60, 80 and 200 columns", "[help]") {
  for (const std::size_t columns : {60U, 80U, 200U})
    for (const Page& page : all_pages(columns))
      for (const std::string& line : lines_of(page.text)) {
        INFO(columns << " columns, " << page.command << ": " << line);
        // Command lines are not broken, so that they can be copied.
        const bool example = line.size() > 2 && std::find(page.examples.begin(), page.examples.end(), line.substr(2)) !=
                                                    page.examples.end();
        CHECK((example || display_width(line) <= columns));
      }
}

TEST_CASE("the examples of the help run as they stand", "[help]") {
  const ScratchDir scratch;
  for (const char* folder : {"quick", "before", "after", "a", "b"}) {
    const Finished run =
        typed(scratch.path(), "aloft run quick --trials 1 --agents min-height,planner --in-process --out results/" +
                                  std::string(folder));
    INFO(run.err);
    REQUIRE(run.exit_code == 0);
  }
  // In this order. The examples left out need an unfinished run, missing data, or an hour.
  for (const char* command : {"help", "validate", "agents", "inspect world", "inspect table", "inspect link", "export",
                              "digest", "compare", "keys init", "keys issue"}) {
    const std::vector<std::string> examples = page_of(command, 80).examples;
    CHECK_FALSE(examples.empty());
    for (const std::string& example : examples) {
      INFO(example);
      const Finished finished = typed(scratch.path(), example);
      INFO(finished.err);
      CHECK(finished.exit_code == 0);
      CHECK_FALSE(finished.out.empty());
    }
  }
  CHECK(typed(scratch.path(), page_of("report", 80).examples.front()).exit_code == 0);
  CHECK(std::filesystem::exists(scratch / "results/quick/report.html"));
  // The examples of `run`, with fewer trials.
  std::filesystem::remove_all(scratch / "results/quick");
  for (const std::string& example : page_of("run", 80).examples) {
    if (example.find("mine.csv") != std::string::npos) continue;
    INFO(example);
    CHECK(typed(scratch.path(), example + " --trials 1 --agents min-height --in-process").exit_code == 0);
  }
}
