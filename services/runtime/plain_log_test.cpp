#include "services/runtime/plain_log.hpp"

#include <spdlog/logger.h>
#include <spdlog/sinks/ostream_sink.h>

#include <catch2/catch.hpp>
#include <sstream>

TEST_CASE("an entry of the log is one line without commands for a terminal, whatever the message says") {
  std::ostringstream text;
  spdlog::logger log("aloft-channel-w0", std::make_shared<spdlog::sinks::ostream_sink_st>(text));
  log.set_formatter(aloft::runtime::plain_log("%n: %v"));
  log.warn("agent {} is there", "x\n2026-01-01 aloft-channel: all is well\033[2J");
  CHECK(text.str() == "aloft-channel-w0: agent x; 2026-01-01 aloft-channel: all is well\\x1b[2J is there\n");
}
