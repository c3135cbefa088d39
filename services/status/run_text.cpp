#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>
#include <vector>

#include "common/base/plain_text.hpp"
#include "services/status/run_view.hpp"

namespace aloft::status {
namespace {

using Json = nlohmann::ordered_json;

/// A text of the run, as it may stand on a line.
std::string text(const Json& object, const char* key) {
  return plain_text(object.at(key).get_ref<const std::string&>());
}

/// "dqn flying, planner lost since 0:12"; those that are merely there by name only.
std::string agents_text(const Json& agents) {
  std::vector<std::string> parts;
  for (const Json& agent : agents) {
    const std::string state = text(agent, "state");
    std::string part = text(agent, "agent");
    if (state == "lost")
      part += " LOST for " + clock_text(agent["silent_s"]);
    else if (state != "ready")
      part += " " + state;
    parts.push_back(std::move(part));
  }
  return parts.empty() ? "none" : fmt::format("{}", fmt::join(parts, ", "));
}

std::string worker_state(const Json& worker) {
  const std::string state = text(worker, "state");
  return state == "lost" ? "LOST " + clock_text(worker["silent_s"]) : state;
}

std::string workers_table(const Json& workers) {
  std::string table = fmt::format("  {:<12} {:<16} {:<10} {:>6} {:>9} {:>9} {:>9} {:>8} {:>6}\n", "worker", "host",
                                  "state", "leases", "flights", "flights/s", "steps/s", "unstored", "drops");
  for (const Json& worker : workers) {
    table += fmt::format("  {:<12} {:<16} {:<10} {:>6} {:>9} {:>9.1f} {:>9.0f} {:>8} {:>6}\n", text(worker, "worker"),
                         text(worker, "host"), worker_state(worker), worker["leases"].size(),
                         worker["flights_done"].get<std::uint64_t>(), worker["flights_per_s"].get<double>(),
                         worker["steps_per_s"].get<double>(), worker["records_unconfirmed"].get<std::uint64_t>(),
                         worker["drops"].get<std::uint64_t>());
    table += "    agents: " + agents_text(worker["agents"]) + "\n";
  }
  return table;
}

/// What a person should know about: who is silent, what waits, the last failures.
std::vector<std::string> troubles(const Json& run) {
  std::vector<std::string> lines;
  if (run["silent_s"].is_null())
    lines.emplace_back("the coordinator has not been heard");
  else if (run["silent_s"].get<double>() > lost_after_s && text(run, "state") == "running")
    lines.push_back("the coordinator has been silent for " + clock_text(run["silent_s"]));
  if (const std::string message = text(run, "message"); !message.empty()) lines.push_back(message);
  if (const std::string message = text(run["collector"], "message"); !message.empty())
    lines.push_back(fmt::format("the collector is {}: {}", text(run["collector"], "state"), message));
  for (const Json& worker : run["workers"]) {
    if (const std::string missing = text(worker, "missing"); !missing.empty())
      lines.push_back(fmt::format("{} waits for {}", text(worker, "worker"), missing));
    if (!worker["failures"].empty())
      lines.push_back(fmt::format("{} gave up {} leases, the last because: {}", text(worker, "worker"),
                                  worker["failures"].size(), text(worker["failures"].back(), "reason")));
  }
  return lines;
}

}  // namespace

std::string clock_text(double seconds) {
  const auto s = static_cast<std::uint64_t>(std::ceil(seconds));
  if (s >= 3600) return fmt::format("{}:{:02}:{:02}", s / 3600, s / 60 % 60, s % 60);
  return fmt::format("{}:{:02}", s / 60, s % 60);
}

std::string run_line(const Json& run) {
  std::size_t alive = 0;
  for (const Json& worker : run["workers"]) alive += text(worker, "state") == "alive" ? 1U : 0U;
  const std::vector<std::string> trouble = troubles(run);
  return fmt::format("{}: {}  {}/{} flights  {:.1f} flights/s  ETA {}  workers {}{}{}", text(run, "run"),
                     text(run, "state"), run["flights_stored"].get<std::uint64_t>(),
                     run["flights_total"].get<std::uint64_t>(), run["flights_per_s"].get<double>(),
                     run["eta_s"].is_null() ? "-:--" : clock_text(run["eta_s"]), alive, trouble.empty() ? "" : "  ",
                     trouble.empty() ? "" : trouble.front());
}

std::string run_text(const Json& run) {
  const Json& trials = run["trials"];
  std::string out = fmt::format("run {}", text(run, "run"));
  if (!text(run, "experiment").empty())
    out += fmt::format(", experiment {} ({})", text(run, "experiment"), text(run, "experiment_id"));
  out += fmt::format("\n  {}: {}/{} flights  {:.1f} flights/s  {:.0f} steps/s  ETA {}\n", text(run, "state"),
                     run["flights_stored"].get<std::uint64_t>(), run["flights_total"].get<std::uint64_t>(),
                     run["flights_per_s"].get<double>(), run["steps_per_s"].get<double>(),
                     run["eta_s"].is_null() ? "-:--" : clock_text(run["eta_s"]));
  out += fmt::format("  trials: {} done, {} leased, {} pending, {} failed; collector: {}\n",
                     trials["done"].get<std::uint64_t>(), trials["leased"].get<std::uint64_t>(),
                     trials["pending"].get<std::uint64_t>(), trials["failed"].get<std::uint64_t>(),
                     text(run["collector"], "state"));
  out += run["workers"].empty() ? "  no worker has been heard\n" : workers_table(run["workers"]);
  for (const std::string& line : troubles(run)) out += "  ! " + line + "\n";
  return out;
}

}  // namespace aloft::status
