#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>
#include <vector>

#include "common/base/plain_text.hpp"
#include "common/base/text_layout.hpp"
#include "services/status/run_view.hpp"

namespace aloft::status {
namespace {

using Json = nlohmann::ordered_json;

/// A text of the run, safe to print on one line.
std::string text(const Json& object, const char* key) {
  return plain_text(object.at(key).get_ref<const std::string&>());
}

/// "dqn flying, planner, LOST for 0:12: min-height, random-walk (aloft-baseline-agent)"; ready agents
/// by name only, lost agents grouped by process.
std::string agents_text(const Json& agents) {
  std::vector<std::string> parts;
  std::map<std::string, std::pair<std::vector<std::string>, double>> lost;  // by process
  for (const Json& agent : agents) {
    const std::string state = text(agent, "state");
    if (state == "lost") {
      auto& [names, silent_s] = lost[text(agent, "process")];
      names.push_back(text(agent, "agent"));
      silent_s = std::max(silent_s, agent["silent_s"].get<double>());
    } else {
      parts.push_back(text(agent, "agent") + (state == "ready" ? "" : " " + state));
    }
  }
  for (const auto& [process, those] : lost)
    parts.push_back(
        fmt::format("LOST for {}: {} ({})", clock_text(those.second), fmt::join(those.first, ", "), process));
  return parts.empty() ? "none" : fmt::format("{}", fmt::join(parts, ", "));
}

std::string worker_state(const Json& worker) {
  const std::string state = text(worker, "state");
  return state == "lost" ? "LOST " + clock_text(worker["silent_s"]) : state;
}

std::string workers_text(const Json& workers, std::size_t width) {
  TextTable table({{"worker"},
                   {"host", 4},
                   {"state"},
                   {"leases", 3},
                   {"flights"},
                   {"flights/s"},
                   {"steps/s", 2},
                   {"unstored", 5},
                   {"drops", 1}});
  std::string agents;
  for (const Json& worker : workers) {
    table.add({text(worker, "worker"), text(worker, "host"), worker_state(worker),
               std::to_string(worker["leases"].size()), std::to_string(worker["flights_done"].get<std::uint64_t>()),
               fmt::format("{:.1f}", worker["flights_per_s"].get<double>()),
               fmt::format("{:.0f}", worker["steps_per_s"].get<double>()),
               std::to_string(worker["records_unconfirmed"].get<std::uint64_t>()),
               std::to_string(worker["drops"].get<std::uint64_t>())});
    // If a worker is lost, so are all its agents.
    if (text(worker, "state") == "alive")
      agents +=
          wrapped(agents_text(worker["agents"]), width, fmt::format("  {} flies: ", text(worker, "worker")), "      ");
  }
  return table.text({.width = width}, table.fitting_rank({.width = width})) + agents;
}

/// Problems that people should know: silent processes, what is waited for, the latest failures.
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

std::string run_text(const Json& run, std::size_t width) {
  const Json& trials = run["trials"];
  const std::string name = text(run, "experiment");
  std::string lines =
      wrapped(fmt::format("run {}{}", text(run, "run"),
                          name.empty() ? "" : fmt::format(", experiment {} ({})", name, text(run, "experiment_id"))),
              width);
  lines += wrapped(fmt::format("{}: {}/{} flights  {:.1f} flights/s  {:.0f} steps/s  ETA {}", text(run, "state"),
                               run["flights_stored"].get<std::uint64_t>(), run["flights_total"].get<std::uint64_t>(),
                               run["flights_per_s"].get<double>(), run["steps_per_s"].get<double>(),
                               run["eta_s"].is_null() ? "-:--" : clock_text(run["eta_s"])),
                   width, "  ", "    ");
  lines += wrapped(fmt::format("trials: {} done, {} leased, {} pending, {} failed; collector: {}",
                               trials["done"].get<std::uint64_t>(), trials["leased"].get<std::uint64_t>(),
                               trials["pending"].get<std::uint64_t>(), trials["failed"].get<std::uint64_t>(),
                               text(run["collector"], "state")),
                   width, "  ", "    ");
  if (!run["middleware"].empty())
    lines += wrapped(fmt::format("middleware: {}", fmt::join(run["middleware"].get<std::vector<std::string>>(), ", ")),
                     width, "  ", "    ");
  lines += run["workers"].empty() ? "  no worker has been heard\n" : workers_text(run["workers"], width);
  for (const std::string& line : troubles(run)) lines += wrapped(line, width, "  ! ", "    ");
  return lines;
}

}  // namespace aloft::status
