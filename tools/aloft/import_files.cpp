#include "tools/aloft/import_files.hpp"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "common/base/build_info.hpp"
#include "common/base/digest.hpp"
#include "common/base/error.hpp"
#include "common/base/write_file.hpp"
#include "services/runtime/flag_checks.hpp"

namespace aloft::cli {

void ImportFiles::add_to(CLI::App& command, const std::string& what_file) {
  command.add_option("file", file, what_file)->required();
  command.add_option("--out", out, "CSV file to write")->required();
  command.add_flag("--force", force, "Replace existing files");
}

void ImportFiles::check_target(const std::vector<std::filesystem::path>& beside) const {
  const std::filesystem::path folder = std::filesystem::absolute(out).parent_path();
  if (!std::filesystem::is_directory(folder))
    throw InputError("--out {}: there is no folder {}. Make it first.", out.string(), folder.string());
  if (std::filesystem::is_directory(out))
    throw InputError("--out {}: this is a folder. Name a CSV file.", out.string());
  std::vector<std::filesystem::path> targets = beside;
  targets.insert(targets.begin(), out);
  for (const std::filesystem::path& target : targets) {
    if (!std::filesystem::exists(target)) continue;
    std::error_code error;
    if (std::filesystem::equivalent(target, file, error))
      throw InputError("--out {}: {} is the file to import itself. Name another CSV file.", out.string(),
                       target.string());
    if (!force)
      throw InputError("--out {}: {} is already there. Give --force to replace it.", out.string(), target.string());
  }
}

std::filesystem::path ImportFiles::beside(const std::string& extension) const {
  std::filesystem::path path = out;
  return path.replace_extension(extension);
}

void ImportFiles::write_facts(const std::string& content, const nlohmann::ordered_json& how) const {
  nlohmann::ordered_json facts{
      {"aloft", build_id()}, {"file", file.filename().string()}, {"file_sha256", sha256_hex(content)}};
  facts.update(how);
  write_file(beside(".import.json"), facts.dump(2) + "\n");
}

void ImportRoute::add_to(CLI::App& command, const std::string& what_points, bool required) {
  command.add_option("--route", points, what_points)->required(required)->type_name("A,B")->expected(1, 16'384);
  command.add_option("--height-min", heights.min_m, "Lowest height, m [the lowest multiple of the step in the data]")
      ->check(runtime::number(0, 10'000));
  command.add_option("--height-max", heights.max_m, "Highest height, m [the highest multiple of the step in the data]")
      ->check(runtime::number(0, 10'000));
  command.add_option("--height-step", heights.step_m, "Distance between two heights, m")
      ->check(runtime::number(1e-3, 10'000))
      ->capture_default_str();
}

std::vector<world::Position> ImportRoute::corners() const {
  std::vector<world::Position> corners;
  for (const std::string& point : points) corners.push_back(importer::parse_point("--route", point));
  return corners;
}

void add_radio_options(CLI::App& command, importer::RadioOptions& radio) {
  command.add_option("--bandwidth", radio.bandwidth_mhz, "Bandwidth, MHz")
      ->check(runtime::number(0.01, 10'000))
      ->capture_default_str();
  command.add_option("--noise-figure", radio.noise_figure_db, "Noise of the receiver above thermal noise, dB")
      ->check(runtime::number(0, 40))
      ->capture_default_str();
  command
      .add_option("--spectral-efficiency-max", radio.spectral_efficiency_max,
                  "Spectral efficiency of the highest modulation, bit/s/Hz; 0: without limit")
      ->check(runtime::number(0, 100))
      ->capture_default_str();
}

std::string size_of(const importer::ImportedWorld& world) {
  return fmt::format("{} steps x {} heights, {:g} to {:g} m", world.route.size(), world.height_m.size(),
                     world.height_m.front(), world.height_m.back());
}

}  // namespace aloft::cli
