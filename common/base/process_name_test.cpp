#include "common/base/process_name.hpp"

#include <unistd.h>

#include <catch2/catch.hpp>
#include <cstdlib>
#include <limits>

using namespace aloft;

TEST_CASE("a process keeps its name until it ends") {
  const ProcessName& self = this_process();
  CHECK(self.known());
  CHECK(self.pid == static_cast<std::uint32_t>(getpid()));
  CHECK_FALSE(self.host.empty());
  CHECK(this_process().incarnation == self.incarnation);
  CHECK_FALSE(ProcessName().known());
}

TEST_CASE("the text of a process has program, host, process id and start time") {
  setenv("TZ", "UTC", 1);
  tzset();
  CHECK(to_text({7, "alpha", 5217, 1'795'355'110}, "aloft-metrics") ==
        "aloft-metrics on host alpha (process 5217, since 2026-11-22 13:45:10)");
  // A start time claimed by another process, however wrong, must not end the process that prints it.
  CHECK(to_text({7, "alpha", 1, std::numeric_limits<std::uint64_t>::max()}, "x").find("9999-12-31") !=
        std::string::npos);
}
