#include "tools/live/flight_watch.hpp"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "common/base/error.hpp"
#include "common/base/limits.hpp"
#include "common/bus/endpoint.hpp"
#include "tools/live/live_page.hpp"

namespace aloft::live {
namespace {

constexpr std::chrono::milliseconds flight_period{250};
/// Whoever looks asks every flight_period.
constexpr std::chrono::milliseconds seen_within{2000};
constexpr std::chrono::milliseconds listen_period{20};
constexpr std::chrono::milliseconds idle_period{100};
constexpr std::size_t watched_limit = 8;
/// What a worker sends costs it, and this process, some microseconds each: so much a second on average is not noticed.
constexpr std::chrono::microseconds time_per_sample{500};
/// In one go; then it rests, also in the middle of a flight.
constexpr std::int64_t samples_in_one_go = 20'000;

}  // namespace

struct FlightWatch::Ears {
  explicit Ears(const bus::BusOptions& place) : participant(place) {}

  void listen() {
    if (!reports) reports.emplace(participant, bus::ReaderOptions{.looks_on = true});
    if (!commands) commands.emplace(participant, bus::ReaderOptions{.looks_on = true});
  }
  void rest() {
    reports.reset();
    commands.reset();
  }

  bus::Participant participant;
  std::optional<bus::Reader<wire::ChannelReport>> reports;
  std::optional<bus::Reader<wire::HeightCommand>> commands;
};

FlightWatch::FlightWatch(bus::BusOptions run) : run_(std::move(run)) {}
FlightWatch::~FlightWatch() = default;

std::chrono::milliseconds FlightWatch::listen() {
  const std::lock_guard lock(mutex_);
  forget_unseen();
  bool listening = false;
  for (auto& [name, worker] : workers_) {
    try {
      hear(name, worker);
      listening = listening || worker.ears->reports.has_value();
    } catch (const std::exception& error) {
      worker.ears.reset();
      worker.problem = error.what();
    }
  }
  return listening ? listen_period : idle_period;
}

void FlightWatch::forget_unseen() {
  const auto unseen = [now = Clock::now()](const auto& stream) { return now - stream.second.asked > seen_within; };
  for (auto& [name, worker] : workers_) std::erase_if(worker.streams, unseen);
  std::erase_if(workers_, [](const auto& worker) { return worker.second.streams.empty(); });
}

void FlightWatch::hear(const std::string& name, Worker& worker) {
  if (!worker.problem.empty()) return;
  if (!worker.ears) {
    bus::BusOptions place = run_;
    place.worker = name;
    worker.ears = std::make_unique<Ears>(place);
  }
  const auto now = Clock::now();
  const bool wanted =
      std::ranges::any_of(worker.streams, [&](const auto& one) { return one.second.log.wants_more(now); });
  if (!wanted || worker.samples > samples_in_one_go) return rest(worker);
  if (now < worker.rests_until) return;
  if (!worker.ears->reports) worker.began = now;
  worker.ears->listen();
  worker.ears->reports->drain([&](const wire::ChannelReport& report) {
    ++worker.samples;
    for (auto& [stream, watched] : worker.streams) watched.log.hear(report, now);
  });
  worker.ears->commands->drain([&](const wire::HeightCommand& command) {
    ++worker.samples;
    for (auto& [stream, watched] : worker.streams) watched.log.hear(command);
  });
}

void FlightWatch::rest(Worker& worker) {
  if (!worker.ears->reports) return;
  worker.ears->rest();
  worker.rests_until = worker.began + worker.samples * time_per_sample;
  worker.samples = 0;
}

http::HttpResponse FlightWatch::answer(const http::HttpRequest& request) {
  const auto name = request.query.find("worker");
  const std::string worker = name == request.query.end() ? "" : name->second;
  if (const std::string objection = bus::name_objection(worker); worker.empty() || !objection.empty())
    throw InputError("{}: 'worker' must be the name of a worker", request.path);
  std::optional<std::uint32_t> stream;
  if (request.query.contains("stream")) stream = number_of(request, "stream");
  if (stream && *stream >= limits::streams)
    throw InputError("{}: 'stream' must be less than {}", request.path, limits::streams);
  const std::lock_guard lock(mutex_);
  std::size_t watched = 0;
  for (const auto& [other, its] : workers_) watched += its.streams.size();
  const auto known = workers_.find(worker);
  if (watched >= watched_limit && (known == workers_.end() || !known->second.streams.contains(stream)))
    throw InputError("{} streams are looked at already; close another page, or look at one of theirs", watched_limit);
  Worker& its = workers_[worker];
  Watched& one = its.streams.try_emplace(stream, stream).first->second;
  one.asked = Clock::now();
  if (!its.problem.empty()) throw std::runtime_error(its.problem);
  return json_answer(one.log.view(one.asked));
}

std::map<std::string, http::HttpRoute> FlightWatch::routes() {
  return {
      {"/events/flight", {[this](const http::HttpRequest& request) { return answer(request); }, false, flight_period}}};
}

}  // namespace aloft::live
