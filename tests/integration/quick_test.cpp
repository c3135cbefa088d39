// The quick start's experiment, flown by processes through the middleware, has the same bytes on every supported
// release of Debian, compiler and Fast DDS: those of tests/golden/quick.sha256, which tools/golden.sh writes.
#include <catch2/catch.hpp>

#include "common/base/write_file.hpp"
#include "common/learn/network.hpp"
#include "tests/integration/command.hpp"
#include "tests/paths.hpp"
#include "tests/skip.hpp"

using namespace aloft::test;

namespace {

std::filesystem::path golden_digest() {
  return source_dir() / "tests/golden/quick.sha256";
}

std::string digest_of_two_trials() {
  const ScratchDir scratch;
  const std::string out = (scratch / "quick").string();
  const Finished run = run_command({"aloft", "run", (source_dir() / "data/experiments/quick.json").string(), "--trials",
                                    "2", "--workers", "2", "--out", out, "--domain", test_domain()},
                                   std::chrono::seconds(200));
  INFO(run.err);
  REQUIRE(run.exit_code == 0);
  return run_command({"aloft", "digest", out}).out;
}

}  // namespace

TEST_CASE("two trials of the quick run have the same bytes on every release of Debian", "[needs-avx2]") {
  if (aloft::learn::available_paths().back() == aloft::learn::Path::portable)
    return skip("this CPU has no AVX2 with FMA, and the portable code rounds differently");
  CHECK(digest_of_two_trials() == read_text(golden_digest()));
}

// Runs only when asked for by name.
TEST_CASE("write the digest anew", "[.regenerate]") {
  aloft::write_file(golden_digest(), digest_of_two_trials());
}
