// A test that cannot run is not reported as passed, and one that fails is not reported as skipped.
#include <catch2/catch.hpp>

#include "tests/integration/command.hpp"
#include "tests/paths.hpp"

using namespace aloft::test;
using Catch::Contains;

TEST_CASE("a test program's exit code: 0 passed, 77 something was skipped, 1 something failed") {
  const auto exit_code = [](const std::string& tests) {
    std::vector<std::string> command{"aloft_harness_sample", tests};
    if (CATCH_VERSION_MAJOR < 3) command.insert(command.end(), {"--warn", "NoTests"});  // what 3 does anyway
    return run_command(command).exit_code;
  };
  CHECK(exit_code("[passes]") == 0);
  CHECK(exit_code("[skips]") == 77);
  CHECK(exit_code("[skips],[passes]") == 77);
  CHECK(exit_code("[fails]") == 1);
  CHECK(exit_code("[skips],[fails]") == 1);
  CHECK(exit_code("[no-such-tag]") == 1);
  CHECK_THAT(run_command({"aloft_harness_sample", "[skips]"}).out,
             Contains("SKIPPED: cannot run here: there is no second moon"));
}

TEST_CASE("ctest reports skipped tests as skipped, and tools/test.sh says why") {
  const ScratchDir scratch;
  write_text(scratch / "CTestTestfile.cmake", "add_test(sample \"" + (bin_dir() / "aloft_harness_sample").string() +
                                                  "\" [skips])\nset_tests_properties(sample PROPERTIES "
                                                  "SKIP_RETURN_CODE 77)\n");
  const std::string folder = scratch.path().string();
  const Finished finished = run_command({(source_dir() / "tools/run_ctest.sh").string(), folder, "--test-dir", folder});
  CHECK(finished.exit_code == 0);
  CHECK_THAT(finished.out, Contains("Skipped") && Contains("SKIPPED: cannot run here: there is no second moon"));
}
