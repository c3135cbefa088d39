#include "tools/export/tensorboard.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <fstream>
#include <map>
#include <regex>
#include <sstream>
#include <system_error>

#include "common/base/error.hpp"
#include "common/base/plain_text.hpp"
#include "common/base/read_file.hpp"
#include "tools/export/event_file.hpp"

namespace aloft::exports {
namespace {

namespace fs = std::filesystem;

/// A folder that is there once it is complete: until commit() it has another name.
class FolderDraft {
 public:
  explicit FolderDraft(const fs::path& folder)
      : folder_(folder.has_filename() ? folder : folder.parent_path()),
        draft_(fmt::format("{}.part-{}", folder_.string(), ::getpid())) {
    if (fs::exists(folder_))
      throw InputError("{} exists already; remove it, or choose another folder", folder_.string());
    std::error_code error;
    if (!fs::create_directory(draft_, error)) fail(error);
  }
  ~FolderDraft() {
    std::error_code ignored;
    if (!committed_) fs::remove_all(draft_, ignored);
  }
  FolderDraft(const FolderDraft&) = delete;
  FolderDraft& operator=(const FolderDraft&) = delete;

  void write(const fs::path& run, const EventFile& events) const {
    std::error_code error;
    fs::create_directories(draft_ / run, error);
    if (error) fail(error);
    // Not write_file(), which waits for the disk: there can be a file for each of many thousand flights.
    std::ofstream file(draft_ / run / "events.out.tfevents.0.aloft", std::ios::binary);
    file << events.bytes();
    file.close();
    if (!file) fail({errno, std::generic_category()});
  }

  void commit() {
    std::error_code error;
    fs::rename(draft_, folder_, error);
    if (error) fail(error);
    committed_ = true;
  }

 private:
  [[noreturn]] void fail(const std::error_code& error) const {
    throw InputError("cannot write '{}': {}", folder_.string(), error.message());
  }

  fs::path folder_;
  fs::path draft_;
  bool committed_ = false;
};

/// As much of a name as is safe in a path.
std::string folder_name(const std::string& name) {
  static const std::regex unsafe("[^A-Za-z0-9.,=+_-]+");
  return std::regex_replace(name, unsafe, "_");
}

std::string folder_of(const experiment::Condition& condition) {
  return fmt::format("{}-{}", condition.index, folder_name(condition.name));
}

Scalars scalars_of(const flight::StepRecord& step, double energy_j) {
  Scalars scalars{{"flight/qos", step.qos},
                  {"flight/reward", step.reward},
                  {"flight/height_m", step.height_m},
                  {"flight/serving_sinr_db", step.serving_sinr_db},
                  {"flight/energy_j", energy_j}};
  if (!step.introspection) return scalars;
  scalars.insert(scalars.end(), {{"learning/epsilon", step.introspection->epsilon},
                                 {"learning/loss", step.introspection->loss},
                                 {"learning/q_down", step.introspection->q_values[0]},
                                 {"learning/q_hold", step.introspection->q_values[1]},
                                 {"learning/q_up", step.introspection->q_values[2]}});
  return scalars;
}

EventFile events_of(const flight::FlightRecord& record, const flight::Costs& costs) {
  EventFile events;
  for (std::size_t i = 0; i < record.steps.size(); ++i) {
    const flight::StepRecord& step = record.steps[i];
    events.add(step.step * costs.step_length_m / costs.speed_m_per_s, step.step,
               scalars_of(step, record.step_energy_j(i, costs)));
  }
  return events;
}

/// "throughput round 3: gain over min-height of the best feasible  +1.234 of +2.345", or with a pair per density.
struct Round {
  std::string network;
  std::int64_t number = 0;
  Scalars gains;
};

Round parse_round(const std::string& line, const fs::path& log, std::size_t line_number) {
  static const std::regex round("([a-z ]+) round (\\d{1,9}): gain over min-height of the best feasible(( .*)?)");
  static const std::regex gain(R"(  (?:(\S+) per km2: )?([+-]\d+\.\d+) of ([+-]\d+\.\d+))");
  constexpr std::size_t longest = 1'000;  // std::regex recurses once per character
  std::smatch match;
  if (line.size() > longest || !std::regex_match(line, match, round))
    throw InputError("{}:{}: this is no line of a validation log of 'aloft train': {}", log.string(), line_number,
                     excerpt(line));
  Round parsed{match[1], std::stol(match[2]), {}};
  const std::string gains = match[3];
  for (auto pair = std::sregex_iterator(gains.begin(), gains.end(), gain); pair != std::sregex_iterator(); ++pair) {
    const std::string place = (*pair)[1].matched ? fmt::format("_at_{}_per_km2", (*pair)[1].str()) : "";
    parsed.gains.emplace_back("gain_over_min_height/network" + place, std::stod((*pair)[2]));
    parsed.gains.emplace_back("gain_over_min_height/best_feasible" + place, std::stod((*pair)[3]));
  }
  return parsed;
}

}  // namespace

void write_events(const store::ResultStore& results, std::span<const store::FlightSummary> flights,
                  const fs::path& folder) {
  const experiment::Experiment& experiment = results.experiment();
  FolderDraft draft(folder);
  for (const store::FlightSummary& flight : flights) {
    const experiment::Condition& condition = experiment.conditions.at(flight.key.condition);
    draft.write(fs::path(folder_of(condition)) / fmt::format("trial-{}", flight.key.trial) / flight.key.agent,
                events_of(store::decode_trace(results.trace(flight.key)), experiment.costs_in(condition)));
  }
  draft.commit();
}

void write_training_events(const fs::path& log, const fs::path& folder) {
  std::istringstream lines(read_file(log));
  std::map<std::string, EventFile> networks;
  std::size_t number = 0;
  for (std::string line; std::getline(lines, line);) {
    const Round round = parse_round(line, log, ++number);
    networks[round.network].add(0.0, round.number, round.gains);
  }
  if (networks.empty()) throw InputError("{}: this validation log has no round yet", log.string());
  FolderDraft draft(folder);
  for (const auto& [network, events] : networks) draft.write(folder_name(network), events);
  draft.commit();
}

}  // namespace aloft::exports
