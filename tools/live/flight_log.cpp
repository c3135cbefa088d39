#include "tools/live/flight_log.hpp"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "tools/report/statistics_view.hpp"

namespace aloft::live {
namespace {

using nlohmann::json;

/// A flight in which nothing happened for longer is over, too: its process may have ended.
constexpr std::chrono::seconds patience{10};
/// Agents of one world may begin and end a little apart.
constexpr std::chrono::milliseconds quiet_time{300};

/// Throughput is reported in kbit/s and shown in Mbit/s.
double scale_of(wire::QosKind kind) {
  return kind == wire::QOS_THROUGHPUT ? 1e-3 : 1.0;
}

std::string flier(const wire::ChannelReport& report) {
  const std::string_view relay = wire::view(report.relay());
  return std::string(relay.empty() ? wire::view(report.agent()) : relay);
}

}  // namespace

FlightLog::Step* FlightLog::Track::at(std::uint32_t step) {
  if (steps.size() >= kept_steps && !steps.contains(step)) {
    if (step < steps.begin()->first) return nullptr;
    steps.erase(steps.begin());
  }
  return &steps[step];
}

std::uint32_t FlightLog::Track::last_step() const {
  const auto last = std::find_if(steps.rbegin(), steps.rend(), [](const auto& entry) { return entry.second.report; });
  return last == steps.rend() ? 0 : last->first;
}

void FlightLog::hear(const wire::ChannelReport& report, Clock::time_point now) {
  streams_[report.stream()] = {flier(report), {report.condition(), report.trial()}};
  if (!stream_) stream_ = report.stream();
  if (report.stream() == *stream_ && is_next(report, now)) {
    world_ = {report.condition(), report.trial()};
    whole_ = report.step() == 0;
    begun_ = now;
    facts_ = report;
    tracks_.clear();
  }
  if (world_ != World{report.condition(), report.trial()}) return;
  heard_ = now;
  add(report);
}

/// A flight that is joined in the air gives way to the next one that is heard from its beginning.
bool FlightLog::is_next(const wire::ChannelReport& report, Clock::time_point now) const {
  if (!world_) return true;
  if (*world_ == World{report.condition(), report.trial()}) return false;
  return (!whole_ && report.step() == 0) || (over(now) && now - begun_ >= show_time);
}

bool FlightLog::over(Clock::time_point now) const {
  if (now - heard_ > patience) return true;
  return now - heard_ > quiet_time && std::ranges::all_of(tracks_, [](const auto& one) { return one.second.over; });
}

void FlightLog::add(const wire::ChannelReport& report) {
  Track& track = tracks_[flier(report)];
  if (report.attempt() < track.attempt) return;  // a late one of a flight that was begun anew
  if (report.attempt() > track.attempt || report.episode_id() != track.episode_id)
    track = {report.stream(), report.episode_id(), report.attempt(), false, {}};
  track.over = report.last();
  if (report.step() == 0) return;
  if (Step* step = track.at(report.step())) step->report = report;
}

void FlightLog::hear(const wire::HeightCommand& command) {
  if (!command.has_introspection()) return;
  for (auto& [name, track] : tracks_) {
    if (track.stream != command.stream() || track.episode_id != command.episode_id() ||
        track.attempt != command.attempt())
      continue;
    if (Step* step = track.at(command.step())) step->learning = {command.epsilon(), command.loss(), command.q_values()};
  }
}

bool FlightLog::wants_more(Clock::time_point now) const {
  return !world_ || !over(now) || now - begun_ >= show_time;
}

json FlightLog::view(Clock::time_point now) const {
  json streams = json::array();
  for (const auto& [stream, seen] : streams_)
    streams.push_back(
        {{"stream", stream}, {"agent", seen.agent}, {"condition", seen.world.condition}, {"trial", seen.world.trial}});
  return {{"stream", stream_ ? json(*stream_) : json()},
          {"streams", std::move(streams)},
          {"flight", world_ ? flight(now) : json()}};
}

json FlightLog::flight(Clock::time_point now) const {
  using report::rounded;
  using report::significant;
  std::uint32_t last = 0;
  for (const auto& [name, track] : tracks_) last = std::max(last, track.last_step());
  const std::uint32_t end = std::max(last, std::min<std::uint32_t>(facts_.steps(), kept_steps));
  const std::uint32_t first = end > kept_steps ? end - static_cast<std::uint32_t>(kept_steps) + 1 : 1;
  const double scale = scale_of(facts_.qos_kind());
  json steps = json::array();
  for (std::uint32_t step = first; step <= end; ++step) steps.push_back(step);
  json agents = json::array();
  for (const auto& [name, track] : tracks_) {
    json one{{"name", name}, {"stream", track.stream}, {"at", track.last_step()}, {"learning", nullptr}};
    for (const char* field : {"height_m", "qos", "serving_cell", "x_m", "y_m", "sinr_db", "reward"})
      one[field] = json::array_t(end - first + 1);
    const auto learning = [&](const char* curve) -> json& {
      json& curves = one["learning"];
      if (!curves.contains(curve)) curves[curve] = json::array_t(end - first + 1);
      return curves[curve];
    };
    for (const auto& [step, heard] : track.steps) {
      if (step < first || step > end) continue;
      const std::size_t i = step - first;
      if (heard.report) {
        one["height_m"][i] = rounded(heard.report->height_m());
        one["qos"][i] = rounded(heard.report->qos() * scale);
        one["serving_cell"][i] = heard.report->serving_cell();
        one["x_m"][i] = rounded(heard.report->x_m());
        one["y_m"][i] = rounded(heard.report->y_m());
        one["sinr_db"][i] = rounded(heard.report->serving_sinr_db());
        one["reward"][i] = rounded(heard.report->reward() * scale);
      }
      if (heard.learning) {
        learning("epsilon")[i] = significant(heard.learning->epsilon);
        learning("loss")[i] = significant(heard.learning->loss);
        learning("q_down")[i] = significant(heard.learning->q_values[0]);
        learning("q_hold")[i] = significant(heard.learning->q_values[1]);
        learning("q_up")[i] = significant(heard.learning->q_values[2]);
      }
    }
    agents.push_back(std::move(one));
  }
  return {{"condition", world_->condition},
          {"trial", world_->trial},
          {"over", over(now)},
          {"step", std::move(steps)},
          {"height_min_m", facts_.height_min_m()},
          {"height_max_m", facts_.height_max_m()},
          {"height_step_m", facts_.height_step_m()},
          {"agents", std::move(agents)}};
}

}  // namespace aloft::live
