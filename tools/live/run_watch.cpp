#include "tools/live/run_watch.hpp"

#include <nlohmann/json.hpp>

#include "tools/live/live_page.hpp"

namespace aloft::live {
namespace {

constexpr std::chrono::milliseconds run_period{500};

}  // namespace

void RunWatch::listen() {
  const std::lock_guard lock(mutex_);
  observer_.listen();
  (void)follower_.update();
}

std::shared_ptr<const experiment::Experiment> RunWatch::experiment() const {
  const std::lock_guard lock(mutex_);
  return follower_.experiment();
}

std::map<std::string, http::HttpRoute> RunWatch::routes() const {
  const auto news = [this](const http::HttpRequest&) {
    const std::lock_guard lock(mutex_);
    return json_answer(observer_.view().to_json(status::Clock::now()));
  };
  return {{"/events/run", {news, true, run_period}}};
}

}  // namespace aloft::live
