#pragma once

#include <filesystem>
#include <functional>
#include <optional>

#include "common/store/result_store.hpp"
#include "services/coordinator/own_collector.hpp"

namespace aloft::coordinator {

/// What the coordinator sees in its result folder: the database that its collector makes and writes.
class ResultsView {
 public:
  ResultsView(std::filesystem::path folder, const experiment::Experiment& experiment)
      : folder_(std::move(folder)), experiment_(experiment) {}

  /// The database; null if there is none. One that cannot be read may be unfinished, so this tries again until
  /// `wait` (which lasts a moment) returns false. Then it throws what ResultStore::open_for_reading throws. InputError
  /// if the results are those of another experiment.
  const store::ResultStore* open(const std::function<bool()>& wait);
  /// Null if it is not open.
  [[nodiscard]] const store::ResultStore* database() const noexcept { return database_ ? &*database_ : nullptr; }
  /// The collector that writes there; none if that cannot be read at this moment.
  [[nodiscard]] std::optional<OwnCollector::Folder> look();

 private:
  std::filesystem::path folder_;
  const experiment::Experiment& experiment_;
  std::optional<store::ResultStore> database_;
};

}  // namespace aloft::coordinator
