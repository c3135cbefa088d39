#include "tools/aloft/progress.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <cstdio>

#include "common/base/plain_text.hpp"
#include "services/status/run_view.hpp"

namespace aloft::cli {
namespace {

constexpr std::chrono::milliseconds redraw_period{200};
constexpr std::chrono::seconds plain_line_period{5};

}  // namespace

Progress::Progress(std::uint64_t flights_total, std::uint64_t flights_already_done)
    : terminal_(isatty(STDERR_FILENO) == 1),
      total_(flights_total),
      already_done_(flights_already_done),
      drawn_(Clock::now()) {}

void Progress::update(std::uint64_t flights_done, unsigned workers_alive, unsigned workers_wanted,
                      const std::string& message) {
  const double elapsed_s = std::chrono::duration<double>(Clock::now() - started_).count();
  const std::uint64_t flown = flights_done > already_done_ ? flights_done - already_done_ : 0;
  const double rate = elapsed_s > 0 ? static_cast<double>(flown) / elapsed_s : 0.0;
  const std::string eta =
      flown == 0 ? "-:--" : status::clock_text(static_cast<double>(total_ - std::min(flights_done, total_)) / rate);
  const bool others_joined = workers_alive > workers_wanted || workers_wanted == 0;
  text_ = fmt::format("{}/{} flights  {:.1f} flights/s  ETA {}  workers {}{}", flights_done, total_, rate, eta,
                      workers_alive, others_joined ? "" : fmt::format("/{}", workers_wanted));
  const bool news = !message.empty() && message != last_message_;
  if (!message.empty()) text_ += "  " + plain_text(message);
  last_message_ = message;
  draw(news);
}

void Progress::print(const std::string& line, std::string_view end) const {
  constexpr std::string_view erase_line = "\r\033[K";
  fmt::print(stderr, "{}{}{}", terminal_ ? erase_line : "", line, end);
}

void Progress::draw(bool force) {
  const auto now = Clock::now();
  if (!force && now - drawn_ < (terminal_ ? std::chrono::milliseconds(redraw_period)
                                          : std::chrono::milliseconds(plain_line_period)))
    return;
  drawn_ = now;
  print(text_, terminal_ ? "" : "\n");
  std::fflush(stderr);
}

void Progress::note(const std::string& line) {
  print(plain_text(line), "\n");
  if (terminal_) draw(true);
}

void Progress::finish() {
  if (text_.empty()) return;
  print(text_, "\n");
}

}  // namespace aloft::cli
