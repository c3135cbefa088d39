#pragma once

#include <chrono>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <utility>

#include "common/bus/participant.hpp"
#include "services/http/http_server.hpp"
#include "tools/live/flight_log.hpp"

namespace aloft::live {

/// Flights in the air, for the page. Subscribes to the topics of a worker while somebody looks at it, and of a run that
/// flies fast to one world every few seconds, so that the run does not notice. Thread-safe: one thread listens, the
/// server asks.
class FlightWatch {
 public:
  /// `run`: place of the run; the worker comes with the question.
  explicit FlightWatch(bus::BusOptions run);
  ~FlightWatch();

  /// Takes what has arrived. Returns when to call it again at the latest.
  std::chrono::milliseconds listen();
  /// Events with FlightLog::view(), for ?worker=NAME and, if it is given, &stream=NUMBER. The watch must outlive their
  /// server.
  [[nodiscard]] std::map<std::string, http::HttpRoute> routes();

 private:
  using Clock = FlightLog::Clock;
  struct Ears;  ///< a place in a worker, and what is subscribed to there
  struct Watched {
    explicit Watched(std::optional<std::uint32_t> stream) : log(stream) {}
    FlightLog log;
    Clock::time_point asked;
  };
  struct Worker {
    std::unique_ptr<Ears> ears;
    std::map<std::optional<std::uint32_t>, Watched> streams;
    std::string problem;            ///< why it cannot be listened to
    Clock::time_point began;        ///< to listen
    std::int64_t samples = 0;       ///< heard since
    Clock::time_point rests_until;  ///< so that what is heard stays within bounds
  };

  [[nodiscard]] http::HttpResponse answer(const http::HttpRequest& request);
  void hear(const std::string& name, Worker& worker);
  static void rest(Worker& worker);
  void forget_unseen();

  bus::BusOptions run_;
  std::mutex mutex_;
  std::map<std::string, Worker> workers_;
};

}  // namespace aloft::live
