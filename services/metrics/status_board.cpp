#include "services/metrics/status_board.hpp"

#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <utility>

namespace aloft::metrics {
namespace {

constexpr auto stalled_after = std::chrono::seconds(10);
constexpr auto forget_workers_after = std::chrono::seconds(10);

const char* to_text(wire::RunState state) noexcept {
  switch (state) {
    case wire::RUN_RUNNING:
      return "running";
    case wire::RUN_STOPPING:
      return "stopping";
    case wire::RUN_FINISHED:
      return "finished";
    case wire::RUN_FAILED:
      return "failed";
  }
  return "unknown";
}

nlohmann::json to_json(const wire::WorkerStatus& worker) {
  nlohmann::json leases = nlohmann::json::array();
  for (const std::uint64_t lease : worker.leases()) leases.push_back(fmt::format("{:016x}", lease));
  return {{"worker", wire::view(worker.worker())},
          {"host", wire::view(worker.host())},
          {"pid", worker.pid()},
          {"capacity", worker.capacity()},
          {"leases", std::move(leases)},
          {"agents_ready", wire::texts(worker.agents_ready())},
          {"flights_done", worker.flights_done()},
          {"steps_done", worker.steps_done()},
          {"records_unconfirmed", worker.records_unconfirmed()},
          {"drops", worker.drops()},
          {"missing", wire::view(worker.missing())}};
}

}  // namespace

StatusBoard::StatusBoard(const experiment::Experiment& experiment, std::string run)
    : run_name_(std::move(run)), experiment_name_(experiment.name), experiment_id_(experiment.id) {
  run_.flights_total(std::uint64_t{experiment.trials} * experiment.conditions.size() * experiment.agents.size());
}

void StatusBoard::on_run(const wire::RunStatus& status) {
  const std::lock_guard lock(mutex_);
  run_ = status;
}

void StatusBoard::on_worker(const wire::WorkerStatus& status) {
  const std::lock_guard lock(mutex_);
  const std::string name(wire::view(status.worker()));
  workers_[name] = status;
  heard_[name] = Clock::now();
}

void StatusBoard::on_tick(Clock::time_point now, const std::string& paused) {
  const std::lock_guard lock(mutex_);
  ticked_ = now;
  paused_ = paused;
  std::erase_if(workers_, [&](const auto& worker) { return now - heard_[worker.first] > forget_workers_after; });
  std::erase_if(heard_, [&](const auto& worker) { return now - worker.second > forget_workers_after; });
}

std::string StatusBoard::status_json() const {
  const std::lock_guard lock(mutex_);
  nlohmann::json workers = nlohmann::json::array();
  for (const auto& [name, worker] : workers_) workers.push_back(to_json(worker));
  const nlohmann::json status{
      {"run", run_name_},
      {"experiment", experiment_name_},
      {"experiment_id", experiment_id_},
      {"state", to_text(run_.state())},
      {"flights_total", run_.flights_total()},
      {"flights_stored", run_.flights_stored()},
      {"trials",
       {{"pending", run_.trials_pending()},
        {"leased", run_.trials_leased()},
        {"done", run_.trials_done()},
        {"failed", run_.trials_failed()}}},
      {"flights_per_s", run_.flights_per_s()},
      {"steps_per_s", run_.steps_per_s()},
      {"message", wire::view(run_.message())},
      {"store", paused_.empty() ? "ok" : paused_},
      {"workers", std::move(workers)},
  };
  return status.dump(2, ' ', false, nlohmann::json::error_handler_t::replace) + "\n";
}

HttpResponse StatusBoard::health(Clock::time_point now) const {
  const std::lock_guard lock(mutex_);
  if (now - ticked_ > stalled_after) return {503, "text/plain", "the collector stands still\n"};
  return {200, "text/plain", paused_.empty() ? "ok\n" : paused_ + "\n"};
}

}  // namespace aloft::metrics
