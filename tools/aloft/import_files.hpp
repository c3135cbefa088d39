#pragma once

#include <CLI/App.hpp>
#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "tools/importer/imported_world.hpp"
#include "tools/importer/link_quality.hpp"

namespace aloft::cli {

/// The files of an import: what is read, and the measured world that is written.
struct ImportFiles {
  std::filesystem::path file;
  std::filesystem::path out;
  bool force = false;

  /// Adds the argument `file`, --out and --force.
  void add_to(CLI::App& command, const std::string& what_file);

  /// Before anything is read: may --out be written, and the files beside it?
  void check_target(const std::vector<std::filesystem::path>& beside = {}) const;

  /// A file beside --out: "grid.csv" and ".sites.csv" make "grid.sites.csv".
  [[nodiscard]] std::filesystem::path beside(const std::string& extension) const;

  /// Writes NAME.import.json: what was read (with its SHA-256), and how it was made into a world.
  void write_facts(const std::string& content, const nlohmann::ordered_json& how) const;
};

/// The options that imports of a route share: --route, --height-min, --height-max, --height-step.
struct ImportRoute {
  std::vector<std::string> points;
  importer::HeightOptions heights;

  void add_to(CLI::App& command, const std::string& what_points, bool required);
  [[nodiscard]] std::vector<world::Position> corners() const;
};

/// --bandwidth, --noise-figure, --spectral-efficiency-max.
void add_radio_options(CLI::App& command, importer::RadioOptions& radio);

/// "60 steps x 11 heights, 20 to 120 m".
[[nodiscard]] std::string size_of(const importer::ImportedWorld& world);

}  // namespace aloft::cli
