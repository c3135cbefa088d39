// Agents outside of Aloft's sources: built against an installation, loaded with --plugin.
#include "common/agents/plugin.hpp"

#include <sys/stat.h>

#include <catch2/catch.hpp>
#include <regex>

#include "common/base/digest.hpp"
#include "tests/install/installed.hpp"
#include "tests/paths.hpp"

using namespace aloft::test;
using Catch::Contains;

namespace {

namespace fs = std::filesystem;

/// Builds a copy of examples/agent, with one text of its source replaced, as a user does who has the installation
/// alone.
fs::path build_example(const fs::path& folder, const std::string& what = "", const std::string& instead = "") {
  fs::copy(installed() / "share/doc/aloft/examples/agent", folder);
  std::string source = read_text(folder / "patient_climber.cpp");
  if (!what.empty()) source.replace(source.find(what), what.size(), instead);
  write_text(folder / "patient_climber.cpp", source);
  const std::string build = (folder / "build").string();
  for (const std::vector<std::string>& command :
       {std::vector<std::string>{"/usr/bin/env", "cmake", "-S", folder.string(), "-B", build,
                                 "-DCMAKE_PREFIX_PATH=" + installed().string()},
        std::vector<std::string>{"/usr/bin/env", "cmake", "--build", build}}) {
    const Finished finished = run_command(command, std::chrono::seconds(200));
    INFO(finished.out << finished.err);
    REQUIRE(finished.exit_code == 0);
  }
  return folder / "build/libpatient_climber.so";
}

const fs::path& example() {
  static const ScratchDir scratch;
  static const fs::path library = build_example(scratch / "agent");
  return library;
}

/// The installed aloft.
Finished installed_aloft(std::vector<std::string> arguments, const fs::path& plugin = example()) {
  arguments.insert(arguments.begin(), (installed() / "bin/aloft").string());
  if (!plugin.empty()) arguments.insert(arguments.end(), {"--plugin", plugin.string()});
  return run_command(arguments, std::chrono::seconds(120));
}

void fly(const fs::path& out, const std::vector<std::string>& more) {
  std::vector<std::string> arguments{"run",   "quick",     "--trials", "2", "--agents", "min-height,patient-climber",
                                     "--out", out.string()};
  arguments.insert(arguments.end(), more.begin(), more.end());
  const Finished run = installed_aloft(arguments);
  INFO(run.err);
  REQUIRE(run.exit_code == 0);
  CHECK_THAT(run.out, Contains("patient-climber"));
}

void check_refused(const fs::path& plugin, const std::string& why) {
  INFO(why);
  for (const std::vector<std::string>& program : {std::vector<std::string>{"aloft", "agents"},
                                                  std::vector<std::string>{"aloft-baseline-agent", "--worker", "w0"}}) {
    std::vector<std::string> arguments = program;
    arguments.insert(arguments.end(), {"--plugin", plugin.string()});
    const Finished finished = run_command(arguments);
    CHECK(finished.exit_code == 2);
    CHECK(finished.out.empty());
    CHECK_THAT(finished.err, Contains(plugin.string()) && Contains(why));
  }
}

}  // namespace

TEST_CASE("the example is built against the installation, listed, and passes the conformance kit") {
  const Finished listed = installed_aloft({"agents", "--brief"});
  CHECK(listed.exit_code == 0);
  CHECK_THAT(listed.out,
             Contains("patient-climber\n") && Contains("plugin: " + example().string()) && Contains("min-height\n"));
  const Finished checked = installed_aloft({"agents", "--check", "patient-climber"});
  INFO(checked.out);
  CHECK(checked.exit_code == 0);
  CHECK(checked.out == "patient-climber: conforms\n");
}

TEST_CASE("the conformance kit finds a fault of a plugin") {
  const ScratchDir scratch;
  const fs::path forgetful = build_example(scratch / "agent", "writer.put_integer(\"failures\", failures_);", "");
  const Finished checked = installed_aloft({"agents", "--check", "patient-climber"}, forgetful);
  CHECK(checked.exit_code == 1);
  CHECK_THAT(checked.out, Contains("agent patient-climber,"));
}

TEST_CASE("an agent of a plugin flies in processes and in one process, with the same bytes") {
  const ScratchDir scratch;
  fly(scratch / "processes", {"--domain", test_domain()});
  fly(scratch / "in-process", {"--in-process"});
  CHECK(installed_aloft({"compare", (scratch / "processes").string(), (scratch / "in-process").string(), "--exact"})
            .exit_code == 0);
  const Finished without = installed_aloft({"digest", (scratch / "processes").string()}, "");
  CHECK(without.exit_code == 2);
  CHECK_THAT(without.err, Contains("unknown agent 'patient-climber'"));
  CHECK_THAT(read_text(scratch / "processes/experiment.json"),
             Contains("\"plugin_sha256\": \"" + aloft::sha256_hex(read_text(example()))));
}

TEST_CASE("another build of a plugin reads the results of the first, and does not fly on with its experiment") {
  const ScratchDir scratch;
  fly(scratch / "first", {"--in-process"});
  const fs::path other = build_example(scratch / "agent", "\"patience\", 3", "\"patience\", 4");
  CHECK(installed_aloft({"digest", (scratch / "first").string()}, other).exit_code == 0);
  const Finished flown = installed_aloft(
      {"run", (scratch / "first/experiment.json").string(), "--in-process", "--out", (scratch / "again").string()},
      other);
  CHECK(flown.exit_code == 2);
  CHECK_THAT(flown.err, Contains("another build of the plugin '" + other.string() + "'"));
  CHECK_FALSE(fs::exists(scratch / "again"));
}

TEST_CASE("what is no plugin, or not for this program, is refused with its path and the reason") {
  const ScratchDir scratch;
  write_text(scratch / "text.so", "no plugin");
  REQUIRE(mkfifo((scratch / "pipe.so").c_str(), 0600) == 0);
  check_refused(scratch / "missing.so", "No such file");
  check_refused(scratch / "text.so", "cannot be loaded");
  check_refused(scratch / "pipe.so", "cannot read");
  const std::vector<std::pair<std::string, std::string>> reasons{
      {"no_plugin", "is no plugin: it does not export aloft_plugin"},
      {"other_interface", "was built for interface " + std::to_string(aloft::agents::plugin_interface + 1)},
      {"other_layout", "was compiled with another layout"},
      {"unknown_symbol", "needs what this program does not have"},
      {"throws", "throws while it names its agents: the model is missing"},
      {"throws_a_number", "throws while it names its agents: something that is no std::exception"},
      {"taken_name", "its agent 'min-height' has the name of another agent"},
      {"bad_name", "its agent 'Min Height' has a name that is not allowed"},
      {"no_make", "its agent 'mine' has no function make"}};
  for (const auto& [name, why] : reasons)
    check_refused(bin_dir().parent_path() / "lib" / ("refused_" + name + ".so"), why);
}

TEST_CASE("a change of what plugins include has a new number of the interface") {
  const std::regex comment(R"(//[^\n]*)");
  const std::regex space(R"(\s+)");
  std::string text;
  for (const std::string& header : files_below(installed() / "include/aloft"))
    text += std::regex_replace(std::regex_replace(read_text(installed() / "include/aloft" / header), comment, ""),
                               space, " ");
  INFO("The headers of plugins have changed: raise plugin_interface (common/agents/plugin.hpp), and write both here.");
  CHECK(aloft::agents::plugin_interface == 4);
  CHECK(aloft::sha256_hex(text) == "800884cc8d78a62ac0bdc564b820dc9af43b25bbf1b20f0241ce01e4ff389b7a");
}
