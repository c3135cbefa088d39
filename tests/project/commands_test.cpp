// The programs accept every command that a document shows, and the commands of the README work in their order.
#include <algorithm>
#include <catch2/catch.hpp>
#include <map>
#include <regex>
#include <set>

#include "tests/integration/command.hpp"
#include "tests/paths.hpp"
#include "tests/project/command_lines.hpp"
#include "tests/project/markdown.hpp"
#include "tools/importer/test_workspace.hpp"

namespace fs = std::filesystem;
using namespace aloft::test;
using Catch::Contains;

namespace {

/// The name of the program, e.g. "aloft" for `build/bin/aloft`; empty if it is none of Aloft's.
std::string program_of(const std::vector<std::string>& words) {
  static const std::regex program("aloft(-[a-z]+)*");
  const std::string name = words.empty() ? "" : fs::path(words.front()).filename().string();
  return std::regex_match(name, program) ? name : "";
}

/// Words up to a redirection or the next command of the line, without environment variables in front.
std::vector<std::string> command_words(const std::string& line) {
  std::vector<std::string> words = shell_words(line);
  while (!words.empty() && std::regex_match(words.front(), std::regex("[A-Z_]+=.*"))) words.erase(words.begin());
  const auto ends = [](const std::string& word) {
    return word == "|" || word == "&&" || word == ";" || word == "&" || word[0] == '>';
  };
  words.erase(std::find_if(words.begin(), words.end(), ends), words.end());
  return words;
}

std::string place(const Document& document, int line) {
  return document.file.lexically_relative(source_dir()).string() + ":" + std::to_string(line) + ": ";
}

/// The output of `command --help`.
const std::string& help_of(const std::string& command) {
  static std::map<std::string, std::string> known;
  std::string& help = known[command];
  if (!help.empty()) return help;
  const Finished finished = run_command(shell_words(command + " --help"));
  INFO(command << " --help: " << finished.err);
  REQUIRE(finished.exit_code == 0);
  return help = finished.out;
}

/// The subcommands that `aloft --help` lists.
std::set<std::string> subcommands() {
  std::set<std::string> names;
  const std::string help = help_of("aloft");
  static const std::regex line(R"(\n  ([a-z][a-z-]+)  )");
  for (auto match = std::sregex_iterator(help.begin(), help.end(), line); match != std::sregex_iterator(); ++match)
    names.insert((*match)[1]);
  return names;
}

bool has_flag(const std::string& command, const std::string& flag) {
  return std::regex_search(help_of(command), std::regex("[ ,]" + flag + "([ =,\n]|$)"));
}

/// All programs and subcommands with a --help.
std::vector<std::string> all_commands() {
  std::vector<std::string> all{"aloft",
                               "aloft inspect world",
                               "aloft inspect table",
                               "aloft inspect link",
                               "aloft keys init",
                               "aloft keys issue",
                               "aloft-environment",
                               "aloft-channel",
                               "aloft-learning-agent",
                               "aloft-baseline-agent",
                               "aloft-coordinator",
                               "aloft-metrics",
                               "aloft-discovery-server"};
  for (const std::string& name : subcommands()) all.push_back("aloft " + name);
  return all;
}

/// Options in `words`, a piece of code inside a sentence, that no command accepts.
std::vector<std::string> unknown_options(const std::vector<std::string>& words) {
  std::vector<std::string> unknown;
  const std::string program = program_of(words);
  if (program.empty() && (words.empty() || !words.front().starts_with("--"))) return unknown;
  std::vector<std::string> commands = all_commands();
  if (program == "aloft" && words.size() > 1 && subcommands().contains(words[1])) {
    const std::string command = "aloft " + words[1];
    std::erase_if(commands, [&](const std::string& other) { return !other.starts_with(command); });
  }
  for (const std::string& word : words) {
    const std::string option = word.substr(0, word.find('='));
    const auto takes = [&](const std::string& command) { return has_flag(command, option); };
    if (word.starts_with("--") && std::none_of(commands.begin(), commands.end(), takes)) unknown.push_back(option);
  }
  return unknown;
}

/// A command of the README that the test runs differently or not at all.
struct Exception {
  std::string command;
  std::string instead;  ///< appended to the command; "-": not run at all
  std::string reason;
};

const std::vector<Exception> exceptions{
    {"tools/quickstart.sh", "--trials 1", "20 trials of the DQN take a minute"},
    {"tools/test.sh", "-", "it is what runs this test"},
    {"aloft run data/experiments/bs-density.json --workers 2", "--trials 1", "100 trials of the DQN take minutes"},
    {"aloft run data/experiments/measured.json --set world.file=grid.csv --out results/mine", "--trials 1", "likewise"},
    {"aloft run data/experiments/quick.json --secure keys --out results/secured", "--trials 1", "likewise"},
    {"aloft tournament", "--trials 2 --dqn-trials 1 --in-process", "half an hour"},
    {"aloft reproduce", "--trials 1", "minutes of the DQN"},
    {"aloft reproduce --data gcq=gcq.csv", "--trials 1", "likewise"},
    {"aloft status --watch", "-", "it ends with Ctrl-C; tests/integration/status_test.cpp runs it"},
    {"aloft live results/quick", "-", "likewise; tests/live/page_test.mjs opens it"},
    {"aloft swap --run lab --worker w0 --agent dqn", "-",
     "it needs a run in the air; tests/integration/swap_test.cpp has one"},
};

/// A copy of the checkout with this build, in which the commands of the README write their files.
class Copy {
 public:
  Copy() {
    for (const char* entry : {"data", "docs"})
      fs::copy(source_dir() / entry, root_ / entry, fs::copy_options::recursive);
    fs::create_directories(root_ / "tools");
    fs::copy_file(source_dir() / "tools/quickstart.sh", root_ / "tools/quickstart.sh");
    write_text(root_ / "tools/setup.sh", "#!/bin/sh\n");  // everything is installed and built already
    fs::permissions(root_ / "tools/setup.sh", fs::perms::owner_all);
    fs::create_directory_symlink(bin_dir().parent_path(), root_ / "build");
    write_text(root_ / "grid.csv", read_text(source_dir() / "data/samples/measured_sample.csv"));
    namespace workspace = aloft::importer::test;
    const workspace::Recorder flight = workspace::north_wall_quay_like();
    workspace::write_bytes(root_ / "Real_canal_tudo1.Rdata",
                           workspace::gzip(workspace::xdr_workspace(
                               workspace::objects(flight.record(workspace::one_flight_per_level(flight))))));
  }

  /// Runs a command in bash, after the `export` lines before it.
  [[nodiscard]] Finished run(const std::string& command) {
    if (command.starts_with("export ")) environment_ += command + "\n";
    return run_command({"/bin/bash", "-c", "cd '" + root_.path().string() + "'\n" + environment_ + command},
                       std::chrono::seconds(300));
  }

  void write(const std::string& name, const std::string& text) const { write_text(root_ / name, text); }

 private:
  ScratchDir root_;
  std::string environment_;
};

/// Keeps the runs of the test apart from others in DDS domain 0.
std::string with_domain(const std::string& command) {
  const std::vector<std::string> words = command_words(command);
  if (program_of(words) != "aloft" || words.size() < 2) return command;
  return has_flag("aloft " + words[1], "--domain") ? command + " --domain " + test_domain() : command;
}

}  // namespace

TEST_CASE("the programs accept every aloft command in the shell code of documents") {
  int commands = 0;
  for (const Document& document : all_documents())
    for (const Located& line : commands_of(document)) {
      std::vector<std::string> words = command_words(line.text);
      const std::string program = program_of(words);
      if (program.empty()) continue;
      ++commands;
      words.front() = program;
      for (std::string& word : words)  // experiments of the reader's own
        if (word.ends_with(".json") && !fs::exists(source_dir() / word)) word = "data/experiments/quick.json";
      if (ALOFT_SECURED_RUNS == 0)  // refused before all else
        if (const auto secure = std::ranges::find(words, "--secure"); secure != words.end())
          words.erase(secure, secure + 2);
      words.emplace_back("--unheard-of");  // an unknown option, so that nothing runs; it is reported last
      const Finished finished = run_command(words);
      INFO(place(document, line.line) << line.text);
      CHECK(finished.exit_code == 2);
      CHECK_THAT(finished.err, Contains("The following argument was not expected: --unheard-of"));
    }
  CHECK(commands > 40);
}

TEST_CASE("every command and option that a document names in its text exists") {
  const std::set<std::string> commands = subcommands();
  CHECK(commands.size() > 15);
  for (const Document& document : all_documents())
    for (const Located& span : document.code_spans) {
      const std::vector<std::string> words = command_words(span.text);
      INFO(place(document, span.line) << span.text);
      if (program_of(words) == "aloft" && words.size() > 1 && !words[1].starts_with('-'))
        CHECK(commands.contains(words[1]));
      CHECK(unknown_options(words) == std::vector<std::string>{});
    }
}

TEST_CASE("the commands of the README work in their order") {
  const fs::path file = source_dir() / "README.md";
  const Document readme = parse_document(file, read_text(file));
  Copy copy;
  for (const CodeBlock& block : readme.code_blocks)
    if (block.language == "json") {
      std::string text;
      for (const std::string& line : block.code) text += line + "\n";
      copy.write("my-experiment.json", text);
    }
  std::set<std::string> used;
  for (const Located& line : commands_of(readme)) {
    std::string command = line.text;
    const auto found =
        std::find_if(exceptions.begin(), exceptions.end(), [&](const auto& one) { return one.command == command; });
    if (found != exceptions.end()) {
      used.insert(command);
      if (found->instead == "-") continue;
      command += " " + found->instead;
    }
    const Finished finished = copy.run(with_domain(command));
    INFO("README.md:" << line.line << ": " << command << "\n" << finished.err);
    // This test does not judge the machine.
    const bool refused = ALOFT_SECURED_RUNS == 0 && line.text.find("--secure") != std::string::npos;
    const bool as_it_should = refused
                                  ? finished.exit_code == 2
                                  : finished.exit_code == 0 || (line.text == "aloft doctor" && finished.exit_code == 1);
    CHECK(as_it_should);
  }
  for (const Exception& exception : exceptions) {
    INFO(exception.command);
    CHECK(used.contains(exception.command));
  }
}
