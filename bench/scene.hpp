#pragma once

#include <stdlib.h>

#include <filesystem>
#include <string>

#include "common/base/error.hpp"
#include "common/store/result_store.hpp"

namespace bench {

/// A folder on the disk of the current directory, where results usually go; removed with this object.
class Folder {
 public:
  Folder() {
    std::string pattern = (std::filesystem::current_path() / "aloft-bench-XXXXXX").string();
    if (::mkdtemp(pattern.data()) == nullptr)
      throw aloft::InputError("cannot make a scratch folder in the current directory; change to a writable one");
    path = pattern;
  }
  ~Folder() { std::filesystem::remove_all(path); }
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;
  std::filesystem::path path;
};

/// A made-up flight of "random-walk", as large as a real one.
inline std::string encoded_flight_of_100_steps() {
  aloft::flight::FlightRecord record;
  record.pilots = {"random-walk"};
  for (std::uint32_t step = 1; step <= 100; ++step) {
    aloft::flight::StepRecord& added = record.steps.emplace_back();
    added.step = step;
    added.action = aloft::agents::Action::up;
    added.x_m = -505.0 + 10 * step;
    added.y_m = 3.7;
    added.height_m = 40.0 + step % 20;
    added.serving_cell = 3;
    added.serving_sinr_db = 0.31 * step;
    added.qos = added.reward = 4.1 + 0.01 * step;
  }
  return aloft::store::encode_trace(record);
}

}  // namespace bench
