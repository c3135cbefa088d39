#define CATCH_CONFIG_RUNNER
#include <catch2/catch.hpp>
#include <iostream>

#include "tests/skip.hpp"

namespace {

constexpr int skipped_code = 77;  // SKIP_RETURN_CODE in cmake/AloftTargets.cmake
bool skipped = false;

}  // namespace

void aloft::test::skip(const std::string& reason) {
  skipped = true;
  std::cout << "SKIPPED: " << Catch::getResultCapture().getCurrentTestName() << ": " << reason << std::endl;
}

int main(int argc, char** argv) {
  // Catch2 returns the number of failed checks, which can be 77 as well.
  if (Catch::Session().run(argc, argv) != 0) return 1;
  return skipped ? skipped_code : 0;
}
