#include <fmt/format.h>

#include <algorithm>

#include "common/base/error.hpp"
#include "common/base/write_file.hpp"
#include "services/runtime/flag_checks.hpp"
#include "tools/aloft/commands.hpp"
#include "tools/aloft/import_files.hpp"
#include "tools/importer/measurement_grid.hpp"

namespace aloft::cli {
namespace {

struct ImportOptions {
  ImportFiles files;
  importer::GridOptions grid;
};

void print_outcome(const ImportOptions& options, const importer::MeasurementGrid& grid) {
  const auto recorded = std::ranges::count(grid.observed, true);
  fmt::print(
      "{}: {} steps x {} heights, {} to {} m; {} of {} cells recorded (from {} triples), the others filled in and "
      "marked observed = 0\n",
      options.files.out.string(), grid.steps, grid.heights, grid.height_min_m,
      grid.height_min_m + grid.height_step_m * (grid.heights - 1), recorded, grid.observed.size(), grid.triples);
  if (grid.above_known_maximum > 0)
    fmt::print(stderr,
               "warning: {} recorded values are above the maximum that the workspace gives for their step; the "
               "recorded values were kept\n",
               grid.above_known_maximum);
}

int import_rdata(const ImportOptions& options) {
  options.files.check_target();
  const importer::MeasurementGrid grid =
      importer::rebuild_grid(importer::read_r_workspace(options.files.file), options.grid, options.files.file.string());
  write_file(options.files.out, importer::to_csv(grid));
  print_outcome(options, grid);
  return exit_ok;
}

}  // namespace

void add_import_rdata(CLI::App& app, Job& job) {
  auto* command = app.add_subcommand(
      "import-rdata", "Rebuild a measured world (CSV) from an R workspace that the paper's authors published");
  auto options = std::make_shared<ImportOptions>();
  options->files.add_to(*command, "The workspace, e.g. Real_canal_tudo1.Rdata");
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
