#include "tools/aloft/package_data.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "common/base/error.hpp"
#include "common/base/nearest.hpp"
#include "tools/aloft/supervise/processes.hpp"

namespace aloft::cli {
namespace {

std::filesystem::path experiments_folder() {
  return program_path("..") / "share" / "aloft" / "experiments";
}

std::filesystem::path file_of(const std::string& name) {
  return std::filesystem::weakly_canonical(experiments_folder() / (name + ".json"));
}

}  // namespace

std::vector<std::string> package_experiments() {
  std::vector<std::string> names;
  std::error_code absent;
  for (const auto& entry : std::filesystem::directory_iterator(experiments_folder(), absent))
    if (entry.path().extension() == ".json") names.push_back(entry.path().stem().string());
  std::ranges::sort(names);
  return names;
}

std::filesystem::path find_experiment(const std::filesystem::path& given) {
  std::error_code ignored;
  if (std::filesystem::exists(given, ignored) && !std::filesystem::is_directory(given, ignored)) return given;
  const std::vector<std::string> names = package_experiments();
  const std::string name = given.string();
  if (std::ranges::find(names, name) != names.end()) return file_of(name);
  throw InputError("'{}' is {}, and no experiment of the package has this name.{} {}", name,
                   std::filesystem::is_directory(given, ignored) ? "a folder" : "no file here",
                   did_you_mean(name, names),
                   names.empty() ? fmt::format("The package's experiments are missing: there is no {}",
                                               experiments_folder().lexically_normal().string())
                                 : fmt::format("The package has: {}", fmt::join(names, ", ")));
}

}  // namespace aloft::cli
