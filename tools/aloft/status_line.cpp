#include "tools/aloft/status_line.hpp"

#include <fmt/format.h>
#include <spdlog/sinks/base_sink.h>
#include <spdlog/sinks/dup_filter_sink.h>
#include <spdlog/spdlog.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <memory>

#include "common/base/plain_text.hpp"
#include "common/base/terminal.hpp"
#include "common/base/text_layout.hpp"
#include "services/runtime/plain_log.hpp"

namespace aloft::cli {
namespace {

constexpr std::chrono::milliseconds redraw_period{200};
constexpr std::chrono::milliseconds plain_line_period{5000};
constexpr std::chrono::seconds repeat_period{60};
constexpr std::string_view erase_line = "\r\033[K";

/// One column less than the row, because some terminals wrap after the last one. COLUMNS can be out of date.
std::size_t row_width() {
  const std::size_t columns = terminal_columns(STDERR_FILENO);
  return std::min(text_width(STDERR_FILENO), columns > 0 ? columns : unlimited_width) - 1;
}

class AboveStatusLine final : public spdlog::sinks::base_sink<std::mutex> {
 protected:
  void sink_it_(const spdlog::details::log_msg& message) override {
    spdlog::memory_buf_t line;
    formatter_->format(message, line);
    StatusLine::of_process().print(std::string_view(line.data(), line.size()));
  }
  void flush_() override {}
};

}  // namespace

StatusLine& StatusLine::of_process() {
  static StatusLine line;
  return line;
}

StatusLine::StatusLine() : terminal_(isatty(STDERR_FILENO) == 1) {}

void StatusLine::show(std::string text, bool now) {
  const std::lock_guard lock(mutex_);
  text_ = std::move(text);
  if (now || Clock::now() - drawn_ >= (terminal_ ? redraw_period : plain_line_period)) draw();
}

void StatusLine::draw() {
  drawn_ = Clock::now();
  const std::string line = plain_text(text_);
  if (terminal_)
    fmt::print(stderr, "{}{}", erase_line, cut_to(line, row_width()));
  else
    fmt::print(stderr, "{}\n", line);
  std::fflush(stderr);
}

void StatusLine::print(std::string_view lines) {
  const std::lock_guard lock(mutex_);
  while (lines.ends_with('\n')) lines.remove_suffix(1);
  fmt::print(stderr, "{}{}\n", terminal_ && !text_.empty() ? erase_line : "", plain_lines(lines));
  if (terminal_ && !text_.empty()) draw();
  std::fflush(stderr);
}

void StatusLine::finish() {
  const std::lock_guard lock(mutex_);
  if (text_.empty()) return;
  draw();
  if (terminal_) fmt::print(stderr, "\n");
  std::fflush(stderr);
  text_.clear();
}

void log_above_status_line() {
  auto told_once = std::make_shared<spdlog::sinks::dup_filter_sink_mt>(repeat_period);
  told_once->add_sink(std::make_shared<AboveStatusLine>());
  spdlog::set_default_logger(std::make_shared<spdlog::logger>("aloft", std::move(told_once)));
  spdlog::set_formatter(runtime::plain_log("%n: %l: %v"));
}

}  // namespace aloft::cli
