#include <fmt/format.h>

#include <atomic>
#include <fstream>
#include <mutex>
#include <nlohmann/json.hpp>
#include <thread>

#include "common/agents/pretrained_model.hpp"
#include "common/base/digest.hpp"
#include "common/base/error.hpp"
#include "tools/aloft/commands.hpp"
#include "tools/train/config.hpp"
#include "tools/train/parallel.hpp"
#include "tools/train/trainer.hpp"

namespace aloft::cli {
namespace {

struct TrainOptions {
  std::filesystem::path config;
  std::filesystem::path out;
  unsigned threads = std::max(1U, std::thread::hardware_concurrency());
};

/// A file appears whole or not at all.
void write_file(const std::filesystem::path& file, const std::string& bytes) {
  const std::filesystem::path part = file.string() + ".part";
  std::ofstream stream(part, std::ios::binary);
  stream << bytes;
  stream.close();
  if (!stream) throw InputError(fmt::format("{}: cannot be written; choose another --out", file.string()));
  std::filesystem::rename(part, file);
}

int train_pretrained(const TrainOptions& options) {
  const train::Config config = train::read_config(options.config);
  if (!options.out.parent_path().empty() && !std::filesystem::is_directory(options.out.parent_path()))
    throw InputError(fmt::format("{}: its folder does not exist; create it first", options.out.string()));
  std::mutex mutex;
  const train::Log log = [&](const std::string& line) {
    const std::lock_guard lock(mutex);
    fmt::print(stderr, "{}\n", line);
  };
  agents::PretrainedModel model;
  // Fitting uses one thread, so the two networks are trained side by side.
  const unsigned sides = std::min(options.threads, 2U);
  train::for_each_item(2, sides, [&](unsigned /*thread*/, std::size_t side) {
    const auto kind = side == 0 ? agents::QosKind::spectral_efficiency : agents::QosKind::throughput;
    const Parameters& settings = side == 0 ? config.spectral_efficiency : config.throughput;
    auto& network = side == 0 ? model.spectral_efficiency : model.throughput;
    network.hidden_width = static_cast<std::size_t>(settings.integer("hidden_width"));
    network.weights = train::Trainer(kind, settings, options.threads / sides, log).train();
  });
  model.training_config = config.canonical().dump();
  const std::string bytes = model.to_bytes();
  write_file(options.out, bytes);
  write_file(options.out.string() + ".sha256",
             fmt::format("{}  {}\n", sha256_hex(bytes), options.out.filename().string()));
  fmt::print("{}: {} bytes, SHA-256 {}\n", options.out.string(), bytes.size(), sha256_hex(bytes));
  return 0;
}

}  // namespace

void add_train(CLI::App& app, Job& job) {
  auto* command = app.add_subcommand("train", "Train a network that is then shipped and flown without learning");
  command->require_subcommand(1);
  auto* pretrained = command->add_subcommand("pretrained", "Train the model of agent 'pretrained' on generated worlds");
  auto options = std::make_shared<TrainOptions>();
  pretrained->add_option("--config", options->config, "Training configuration, JSON")->required();
  pretrained->add_option("--out", options->out, "Model file to write; its SHA-256 goes beside it")->required();
  pretrained->add_option("--threads", options->threads, "Threads; the result is the same for any number")
      ->check(CLI::Range(1U, 1'024U));
  pretrained->callback([options, &job] { job = [options] { return train_pretrained(*options); }; });
}

}  // namespace aloft::cli
