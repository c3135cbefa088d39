#include "services/coordinator/results_view.hpp"

#include <spdlog/spdlog.h>

#include "common/base/error.hpp"

namespace aloft::coordinator {

const store::ResultStore* ResultsView::open(const std::function<bool()>& wait) {
  if (database_ && !database_->in_place()) database_.reset();
  while (!database_ && store::ResultStore::exists(folder_)) {
    try {
      database_.emplace(store::ResultStore::open_for_reading(folder_));
    } catch (const std::exception& error) {
      spdlog::debug("the database is not ready: {}", error.what());
      if (!wait()) throw;
    }
  }
  if (database_ && database_->experiment().id != experiment_.id)
    throw InputError("--results {}: holds results of experiment {} ({}), not of {} ({}); choose another folder",
                     folder_.string(), database_->experiment().name, database_->experiment().id, experiment_.name,
                     experiment_.id);
  return database();
}

std::optional<OwnCollector::Folder> ResultsView::look() {
  try {
    const store::ResultStore* database = open([] { return false; });
    if (database == nullptr) return OwnCollector::Folder{};
    return OwnCollector::Folder{true, database->writer()};
  } catch (const std::exception& error) {
    spdlog::debug("cannot tell who writes the results: {}", error.what());
    return std::nullopt;
  }
}

}  // namespace aloft::coordinator
