// tools/fuzz.sh runs the targets that it is asked for, shows what was found, and names what to do next.
#include <catch2/catch.hpp>

#include "tests/paths.hpp"
#include "tests/project/scripts.hpp"

namespace fs = std::filesystem;
using namespace aloft::test;
using Catch::Contains;

namespace {

/// A checkout with tools/fuzz.sh, in which the target `broken` finds a fault and all others do not.
class Fuzzed : public Scripts {
 public:
  explicit Fuzzed(const std::string& broken) {
    for (const char* folder : {"build-fuzz/bin", "tests/fuzz"}) fs::create_directories(root() / folder);
    copy("tools/fuzz.sh");
    write_text(root() / "build-fuzz/build.ninja", "");
    fs::copy_file(root() / "build/CMakeCache.txt", root() / "build-fuzz/CMakeCache.txt");
    write_text(root() / "tests/fuzz/CMakeLists.txt", "aloft_add_fuzzer(trace DEPS x)\naloft_add_fuzzer(wire DEPS x)\n");
    write_program("build-fuzz/bin/aloft_fuzz_seeds", "");
    for (const std::string target : {"trace", "wire"})
      write_program(
          "build-fuzz/bin/aloft_fuzz_" + target,
          "echo '#7 DONE   cov: 12 ft: 3 corp: 1/1b'\necho 'stat::number_of_executed_units: 7'\n"
          "[ " +
              target + " != '" + broken +
              "' ] || {\n"
              "  for option; do case $option in -artifact_prefix=*) echo x > ${option#*=}crash-1 ;; esac; done\n"
              "  echo 'SUMMARY: AddressSanitizer: stack-overflow'\n  exit 77\n}\n");
  }
};

}  // namespace

TEST_CASE("tools/fuzz.sh without findings prints a row for each target that was asked for") {
  const Fuzzed checkout("none");
  const Finished all = checkout.run("tools/fuzz.sh 3");
  INFO(all.err);
  CHECK(all.exit_code == 0);
  CHECK_THAT(calls_in(all, {"cmake"}), Contains("--target aloft_fuzzers"));
  CHECK_THAT(all.out, Contains("trace                       7         12  none\n") && Contains("wire  "));
  const Finished one = checkout.run("tools/fuzz.sh 3 wire");
  CHECK_THAT(one.out, Contains("wire  ") && !Contains("trace  "));
}

TEST_CASE("a finding of tools/fuzz.sh ends it with 1, the input is kept, and the next step is named") {
  const Fuzzed checkout("wire");
  const Finished found = checkout.run("tools/fuzz.sh");
  CHECK(found.exit_code == 1);
  CHECK_THAT(found.out, Contains("AddressSanitizer: stack-overflow") &&
                            Contains("build-fuzz/bin/aloft_fuzz_wire tests/fuzz/found/wire/crash-1\n") &&
                            Contains("tests/fuzz/corpus/TARGET/"));
  CHECK(fs::exists(checkout.root() / "tests/fuzz/found/wire/crash-1"));
  CHECK_THAT(read_text(source_dir() / ".gitignore"), Contains("/tests/fuzz/found/"));
}

TEST_CASE("tools/fuzz.sh names what is allowed, and does nothing") {
  const Fuzzed checkout("none");
  for (const char* minutes : {"0", "-1", "1441", "two", "''", "1.5"}) {
    INFO(minutes);
    const Finished refused = checkout.run(std::string("tools/fuzz.sh ") + minutes);
    CHECK(refused.exit_code == 2);
    CHECK_THAT(refused.err, Contains("whole number from 1 to 1440"));
    CHECK(refused.out.empty());
  }
  const Finished target = checkout.run("tools/fuzz.sh 1 wire wir");
  CHECK(target.exit_code == 2);
  CHECK_THAT(target.err, Contains("'wir'") && Contains("use trace wire"));
  checkout.call_machine("ID=debian\nVERSION_ID=\"13\"\n");
  const Finished release = checkout.run("tools/fuzz.sh");
  CHECK(release.exit_code == 2);
  CHECK_THAT(release.err, Contains("Debian 12"));
  CHECK(release.out.empty());
}
