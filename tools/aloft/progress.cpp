#include "tools/aloft/progress.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "common/base/plain_text.hpp"
#include "common/base/seconds.hpp"
#include "services/status/run_view.hpp"
#include "tools/aloft/status_line.hpp"

namespace aloft::cli {
namespace {

constexpr std::chrono::seconds repeat_period{60};

/// Messages that differ only in numbers (seconds, trials) count as the same message.
std::string without_numbers(const std::string& message) {
  std::string kind;
  for (const char c : message) {
    const bool digit = c >= '0' && c <= '9';
    if (!digit || !kind.ends_with('#')) kind += digit ? '#' : c;
  }
  return kind;
}

}  // namespace

Progress::Progress(std::uint64_t flights_total, std::uint64_t flights_already_done)
    : total_(flights_total), already_done_(flights_already_done), done_(flights_already_done) {}

void Progress::update(std::uint64_t flights_done, unsigned workers_alive, unsigned workers_wanted,
                      const std::string& message) {
  const auto now = Clock::now();
  const bool others_joined = workers_alive > workers_wanted || workers_wanted == 0;
  heard_ = true;
  done_ = flights_done;
  workers_ = fmt::format("workers {}{}", workers_alive, others_joined ? "" : fmt::format("/{}", workers_wanted));
  message_ = message;
  pace_.update(flights_done, !message.empty(), now);
  if (!message.empty()) tell(message, now);
  StatusLine::of_process().show(text(now));
}

void Progress::tick() {
  if (heard_) StatusLine::of_process().show(text(Clock::now()));
}

std::string Progress::text(Clock::time_point now) const {
  const double elapsed_s = seconds(now - started_);
  const std::uint64_t flown = done_ > already_done_ ? done_ - already_done_ : 0;
  const double rate = elapsed_s > 0 ? static_cast<double>(flown) / elapsed_s : 0.0;
  std::string pace = fmt::format("{:.1f} flights/s", rate);
  if (const auto blocked = pace_.blocked_for(now); blocked && done_ < total_)
    pace = "nothing stored for " + status::clock_text(seconds(*blocked));
  else if (flown > 0)
    pace += "  ETA " + status::clock_text(static_cast<double>(total_ - std::min(done_, total_)) / rate);
  return fmt::format("{}/{} flights  {}  {}{}{}", done_, total_, pace, workers_, message_.empty() ? "" : "  ",
                     message_);
}

void Progress::tell(const std::string& message, Clock::time_point now) {
  std::erase_if(told_, [&](const auto& entry) { return now - entry.second >= repeat_period; });
  if (told_.emplace(without_numbers(message), now).second) note(message);
}

void Progress::note(const std::string& line) {
  StatusLine::of_process().print(plain_text(line));
}

void Progress::finish() {
  message_.clear();
  if (heard_) StatusLine::of_process().show(text(Clock::now()), true);
  StatusLine::of_process().finish();
}

}  // namespace aloft::cli
