#include "common/bus/middleware/refusals.hpp"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <fastdds/dds/log/Log.hpp>
#include <memory>
#include <regex>

#include "common/bus/neighbourhood.hpp"

namespace aloft::bus {
namespace {

/// Sends the middleware's own warnings to our log.
class LogToSpdlog : public dds::LogConsumer {
 public:
  void Consume(const dds::Log::Entry& entry) override {
    if (const std::string refusal = refusal_in_words(entry.message); !refusal.empty()) {
      spdlog::warn("{}", refusal);
      return;
    }
    const auto level = entry.kind == dds::Log::Kind::Error ? spdlog::level::warn : spdlog::level::debug;
    spdlog::log(level, "dds {}: {}", entry.context.category != nullptr ? entry.context.category : "", entry.message);
  }
};

}  // namespace

std::string refusal_in_words(const std::string& message) {
  static const std::regex pattern(R"(Error checking create remote (writer|reader) ([0-9a-f.]+)\|\S+ \((\S+) topic )");
  std::smatch found;
  if (!std::regex_search(message, found, pattern)) return "";
  return fmt::format("refused to let {} {} {}: not among the permissions of its certificate",
                     Neighbourhood::name_of(found[2]), found[1] == "writer" ? "write" : "read", found[3].str());
}

void take_over_log() {
  dds::Log::ClearConsumers();
  dds::Log::RegisterConsumer(std::make_unique<LogToSpdlog>());
}

}  // namespace aloft::bus
