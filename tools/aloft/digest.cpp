#include <fmt/format.h>

#include "common/store/result_store.hpp"
#include "tools/aloft/commands.hpp"

namespace aloft::cli {

void add_digest(CLI::App& app, Job& job) {
  auto* command =
      app.add_subcommand("digest", "Print one SHA-256 over all flights of a result folder, in canonical order");
  auto dir = std::make_shared<std::filesystem::path>();
  command->add_option("dir", *dir, "Result folder of 'aloft run'")->required();
  command->callback([dir, &job] {
    job = [dir] {
      fmt::print("{}\n", store::ResultStore::open_for_reading(*dir).digest());
      return 0;
    };
  });
}

}  // namespace aloft::cli
