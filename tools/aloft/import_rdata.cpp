#include <fmt/format.h>

#include <algorithm>

#include "common/base/error.hpp"
#include "common/base/write_file.hpp"
#include "services/runtime/flag_checks.hpp"
#include "tools/aloft/commands.hpp"
#include "tools/importer/measurement_grid.hpp"

namespace aloft::cli {
namespace {

struct ImportOptions {
  std::filesystem::path file;
  std::filesystem::path out;
  bool force = false;
  importer::GridOptions grid;
};

/// Before anything is read: may --out be written?
void check_target(const ImportOptions& options) {
  const std::string out = options.out.string();
  const std::filesystem::path folder = std::filesystem::absolute(options.out).parent_path();
  if (!std::filesystem::is_directory(folder))
    throw InputError("--out {}: there is no folder {}. Make it first.", out, folder.string());
  if (!std::filesystem::exists(options.out)) return;
  if (std::filesystem::is_directory(options.out)) throw InputError("--out {}: this is a folder. Name a CSV file.", out);
  std::error_code error;
  if (std::filesystem::equivalent(options.out, options.file, error))
    throw InputError("--out {}: this is the workspace itself. Name a CSV file.", out);
  if (!options.force) throw InputError("--out {}: this file is already there. Give --force to replace it.", out);
}

void print_outcome(const ImportOptions& options, const importer::MeasurementGrid& grid) {
  const auto recorded = std::ranges::count(grid.observed, true);
  fmt::print(
      "{}: {} steps x {} heights, {} to {} m; {} of {} cells recorded (from {} triples), the others filled in and "
      "marked observed = 0\n",
      options.out.string(), grid.steps, grid.heights, grid.height_min_m,
      grid.height_min_m + grid.height_step_m * (grid.heights - 1), recorded, grid.observed.size(), grid.triples);
  if (grid.above_known_maximum > 0)
    fmt::print(stderr,
               "warning: {} recorded values are above the maximum that the workspace gives for their step; the "
               "recorded values were kept\n",
               grid.above_known_maximum);
}

int import_rdata(const ImportOptions& options) {
  check_target(options);
  const importer::MeasurementGrid grid =
      importer::rebuild_grid(importer::read_r_workspace(options.file), options.grid, options.file.string());
  write_file(options.out, importer::to_csv(grid));
  print_outcome(options, grid);
  return exit_ok;
}

}  // namespace

void add_import_rdata(CLI::App& app, Job& job) {
  auto* command = app.add_subcommand(
      "import-rdata", "Rebuild a measured world (CSV) from an R workspace that the paper's authors published");
  auto options = std::make_shared<ImportOptions>();
  command->add_option("file", options->file, "The workspace, e.g. Real_canal_tudo1.Rdata")->required();
  command->add_option("--out", options->out, "CSV file to write")->required();
  command->add_flag("--force", options->force, "Replace an existing file");
  command
      ->add_option("--height-min", options->grid.height_min_m,
                   "Height of level 1, m: 20 at Grand Canal Quay, 30 at North Wall Quay")
      ->check(runtime::number(0, 10'000))
      ->capture_default_str();
  command->add_option("--height-step", options->grid.height_step_m, "Distance between two levels, m")
      ->check(runtime::number(1e-3, 10'000))
      ->capture_default_str();
  command->add_option("--steps", options->grid.steps, "Steps of one flight [detected]")
      ->check(runtime::whole_number(1, 100'000));
  command->callback([options, &job] { job = [options] { return import_rdata(*options); }; });
}

}  // namespace aloft::cli
