#include "services/runtime/plain_log.hpp"

#include <spdlog/pattern_formatter.h>

#include <string_view>

#include "common/base/plain_text.hpp"

namespace aloft::runtime {
namespace {

class PlainMessage final : public spdlog::custom_flag_formatter {
 public:
  void format(const spdlog::details::log_msg& message, const std::tm& /*time*/, spdlog::memory_buf_t& line) override {
    const std::string plain = plain_text(std::string_view(message.payload.data(), message.payload.size()));
    line.append(plain.data(), plain.data() + plain.size());
  }
  [[nodiscard]] std::unique_ptr<custom_flag_formatter> clone() const override {
    return std::make_unique<PlainMessage>();
  }
};

}  // namespace

std::unique_ptr<spdlog::formatter> plain_log(const std::string& pattern) {
  auto formatter = std::make_unique<spdlog::pattern_formatter>();
  formatter->add_flag<PlainMessage>('v').set_pattern(pattern);
  return formatter;
}

}  // namespace aloft::runtime
