// What cmake --install leaves under a prefix.
#include <algorithm>
#include <catch2/catch.hpp>
#include <regex>
#include <set>

#include "tests/install/installed.hpp"
#include "tests/paths.hpp"
#include "tests/skip.hpp"

using namespace aloft::test;
using Catch::Contains;

namespace {

namespace fs = std::filesystem;

const std::vector<std::string> programs{"aloft",
                                        "aloft-baseline-agent",
                                        "aloft-channel",
                                        "aloft-coordinator",
                                        "aloft-discovery-server",
                                        "aloft-environment",
                                        "aloft-learning-agent",
                                        "aloft-metrics"};

Finished shell(const std::string& shell, const std::string& script) {
  return run_command({"/usr/bin/env", shell, "-c", script});
}

bool there_is(const std::string& program) {
  return shell("sh", "command -v " + program).exit_code == 0;
}

/// What bash offers after `line`, whose last word is being typed.
std::string bash_offers(const std::string& line) {
  const fs::path script = installed() / "share/bash-completion/completions/aloft";
  const Finished finished = shell("bash", "source " + script.string() + "; line='" + line + R"('
    read -ra COMP_WORDS <<< "$line"; [[ $line != *' ' ]] || COMP_WORDS+=('')
    COMP_CWORD=$((${#COMP_WORDS[@]} - 1)); _aloft; echo "${COMPREPLY[*]}")");
  CHECK(finished.err.empty());
  return finished.out;
}

}  // namespace

TEST_CASE("an installation has programs, data, documents, units, man pages and completions, in the places of the FHS") {
  std::set<std::string> folders;
  for (const std::string& file : files_below(installed())) folders.insert(fs::path(file).parent_path().string());
  for (const std::string& program : programs) {
    CHECK(fs::exists(installed() / "bin" / program));
    CHECK(fs::exists(installed() / "share/man/man1" / (program + ".1")));
  }
  CHECK(files_below(installed() / "bin").size() == programs.size());
  CHECK(files_below(installed() / "share/aloft") == files_below(source_dir() / "data"));
  for (const char* file : {"README.md", "CHANGELOG.md", "SECURITY.md", "copyright", "deployment.md", "run.env"})
    CHECK(fs::exists(installed() / "share/doc/aloft" / file));
  for (const char* file :
       {"bash-completion/completions/aloft", "zsh/site-functions/_aloft", "fish/vendor_completions.d/aloft.fish"})
    CHECK(fs::exists(installed() / "share" / file));
}

TEST_CASE("nothing installed names the folder of the build or of the sources, and no program has a search path") {
  for (const std::string& file : files_below(installed())) {
    INFO(file);
    const std::string content = read_text(installed() / file);
    if (slowdown > 1 && file.starts_with("bin/")) continue;  // sanitized programs have debug information
    CHECK(content.find(source_dir().string()) == std::string::npos);
    CHECK(content.find(bin_dir().parent_path().string()) == std::string::npos);
  }
  for (const std::string& program : programs) {
    const Finished dynamic =
        run_command({"/usr/bin/env", "readelf", "--dynamic", (installed() / "bin" / program).string()});
    CHECK(dynamic.exit_code == 0);
    CHECK_FALSE(std::regex_search(dynamic.out, std::regex("RPATH|RUNPATH")));
  }
}

TEST_CASE("installed programs find each other and their data wherever the installation is moved") {
  const ScratchDir home;
  const Finished run = run_command({"/usr/bin/env", "--chdir", home.path().string(), "PATH=/usr/bin:/bin",
                                    (installed() / "bin/aloft").string(), "run", "quick", "--trials", "1", "--agents",
                                    "min-height,planner", "--domain", test_domain()});
  INFO(run.err);
  CHECK(run.exit_code == 0);
  CHECK_THAT(run.out, Contains("planner"));
  CHECK(fs::exists(home / "results/quick/summary.json"));
  CHECK(run_command({(installed() / "bin/aloft").string(), "digest", (home / "results/quick").string()}).exit_code ==
        0);
}

TEST_CASE("installed units start installed programs") {
  const std::vector<std::string> units = files_below(source_dir() / "deploy/systemd");
  std::size_t count = 0;
  for (const std::string& unit : units) {
    if (!unit.ends_with(".service")) continue;
    ++count;
    INFO(unit);
    const std::string text = read_text(installed() / "lib/systemd/system" / unit);
    std::smatch start;
    REQUIRE(std::regex_search(text, start, std::regex("ExecStart=(\\S*)/first/(\\S+)")));
    CHECK(fs::exists(installed() / start.str(2)));
    CHECK_THAT(text, !Contains("/usr/"));
  }
  CHECK(count == 4);
}

TEST_CASE("the man page of aloft has every command and option of its help") {
  const std::string page =
      std::regex_replace(read_text(installed() / "share/man/man1/aloft.1"), std::regex(R"(\\-)"), "-");
  const Finished help = run_command({"aloft", "help"});
  static const std::regex command("\n  ([a-z][a-z-]*)  ");
  static const std::regex option("\n  (--[a-z-]+)");
  std::size_t options = 0;
  for (auto at = std::sregex_iterator(help.out.begin(), help.out.end(), command); at != std::sregex_iterator(); ++at) {
    if (at->str(1) == "help") continue;
    CHECK_THAT(page, Contains("\n.SS aloft " + at->str(1) + "\n"));
    const Finished about = run_command({"aloft", "help", at->str(1)});
    for (auto one = std::sregex_iterator(about.out.begin(), about.out.end(), option); one != std::sregex_iterator();
         ++one) {
      CHECK_THAT(page, Contains("\n.B " + one->str(1)));
      ++options;
    }
  }
  CHECK(options > 100);
}

TEST_CASE("man shows the pages without a warning", "[needs-man]") {
  if (!there_is("man")) return skip("there is no man");
  for (const std::string& program : programs) {
    const Finished man = run_command({"/usr/bin/env", "MANWIDTH=80", "man", "--warnings", "--local-file",
                                      (installed() / "share/man/man1" / (program + ".1")).string()});
    INFO(program);
    CHECK(man.exit_code == 0);
    CHECK(man.err.empty());
    CHECK_THAT(man.out, Contains("SYNOPSIS") && Contains("OPTIONS"));
  }
}

TEST_CASE("bash completes commands, options, choices and experiments") {
  CHECK_THAT(bash_offers("aloft "), Contains("run validate") && Contains("--version"));
  CHECK(bash_offers("aloft keys i") == "init issue\n");
  CHECK(bash_offers("aloft run --form") == "--format\n");
  CHECK(bash_offers("aloft run --format ") == "text json\n");
  CHECK(bash_offers("aloft run qui") == "quick\n");
  CHECK(bash_offers("aloft completions ") == "--help bash zsh fish\n");
  CHECK(bash_offers("aloft run --out re") == "\n");  // bash goes on with files
}

TEST_CASE("zsh takes the completions", "[needs-zsh]") {
  if (!there_is("zsh")) return skip("there is no zsh");
  const std::string script = (installed() / "share/zsh/site-functions/_aloft").string();
  const auto offers = [&](const std::string& line) {  // instead of the functions of zsh, what they are called with
    const Finished finished = shell("zsh", "_describe() { print -l $2 ${(P)2}; }; _files() { print files; }; words=(" +
                                               line + "); CURRENT=$#words; source " + script);
    CHECK(finished.err.empty());
    return finished.out;
  };
  CHECK_THAT(offers("aloft ''"), Contains("\nrun:Run an experiment") && Contains("\n--version:"));
  CHECK_THAT(offers("aloft keys ''"), Contains("\ninit:") && !Contains("\nrun:"));
  CHECK(offers("aloft run --format ''") == "found\ntext\njson\n");
  CHECK(offers("aloft run --out ''") == "files\n");
}

TEST_CASE("fish takes the completions", "[needs-fish]") {
  if (!there_is("fish")) return skip("there is no fish");
  const std::string script = (installed() / "share/fish/vendor_completions.d/aloft.fish").string();
  const auto offers = [&](const std::string& line) {
    const Finished finished = shell("fish", "source " + script + "; complete -C '" + line + "'");
    CHECK(finished.err.empty());
    return finished.out;
  };
  CHECK_THAT(offers("aloft "), Contains("run\tRun an experiment") && Contains("keys\t"));
  CHECK_THAT(offers("aloft keys i"), Contains("init\t") && Contains("issue\t"));
  CHECK_THAT(offers("aloft run --format "), Contains("text") && Contains("json"));
  CHECK_THAT(offers("aloft run --form"), Contains("--format\t"));
}

TEST_CASE("a build without tests and benchmarks looks for none of their packages") {
  const ScratchDir build;
  std::vector<std::string> configure{
      "/usr/bin/env",        "cmake", "-S",    source_dir().string(), "-B",
      build.path().string(), "-G",    "Ninja", "-DALOFT_TESTS=OFF",   "-DALOFT_BENCHMARKS=OFF"};
  for (const char* package : {"Catch2", "rapidcheck", "valijson", "benchmark", "CycloneDDS"})
    configure.push_back("-DCMAKE_DISABLE_FIND_PACKAGE_" + std::string(package) + "=ON");
  const Finished configured = run_command(configure);
  INFO(configured.err);
  REQUIRE(configured.exit_code == 0);
  const std::string rules = read_text(build / "build.ninja");
  for (const std::string& program : programs) CHECK_THAT(rules, Contains("build bin/" + program + ":"));
  CHECK_THAT(rules, !Contains("_test.cpp") && !Contains("/tests/") && !Contains("/bench/"));
  CHECK_THAT(read_text(build / "CMakeCache.txt"), !Contains("CMARK"));
}

TEST_CASE("a build of the Python package alone looks for none of the packages of the programs") {
  const ScratchDir build;
  std::vector<std::string> configure{
      "/usr/bin/env",          "cmake", "-S",    source_dir().string(),  "-B",
      build.path().string(),   "-G",    "Ninja", "-DALOFT_PROGRAMS=OFF", "-DALOFT_TESTS=OFF",
      "-DALOFT_BENCHMARKS=OFF"};
  for (const char* package : {"Boost", "CLI11", "ZLIB", "fastcdr", "fastdds", "fastrtps", "prometheus-cpp", "spdlog"})
    configure.push_back("-DCMAKE_DISABLE_FIND_PACKAGE_" + std::string(package) + "=ON");
  const Finished configured = run_command(configure);
  INFO(configured.err);
  REQUIRE(configured.exit_code == 0);
  const std::string rules = read_text(build / "build.ninja");
  CHECK_THAT(rules, Contains("build python/libaloft_fleet.a:") && !Contains("/services/") && !Contains("/bus/"));
}
