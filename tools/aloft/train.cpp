#include <fmt/format.h>

#include <array>
#include <atomic>
#include <mutex>
#include <nlohmann/json.hpp>

#include "common/agents/pretrained_model.hpp"
#include "common/base/cores.hpp"
#include "common/base/digest.hpp"
#include "common/base/error.hpp"
#include "common/base/read_file.hpp"
#include "common/base/write_file.hpp"
#include "services/runtime/flag_checks.hpp"
#include "tools/aloft/commands.hpp"
#include "tools/aloft/interrupt.hpp"
#include "tools/aloft/status_line.hpp"
#include "tools/train/config.hpp"
#include "tools/train/parallel.hpp"
#include "tools/train/trainer.hpp"

namespace aloft::cli {
namespace {

struct TrainOptions {
  std::filesystem::path config;
  std::filesystem::path out;
  unsigned threads = usable_cores();
};

constexpr std::uint64_t largest_checkpoint_bytes = std::uint64_t{16} << 30U;

/// The networks that a model holds.
constexpr std::array kinds{radio::QosKind::spectral_efficiency, radio::QosKind::throughput};

std::string key_of(radio::QosKind kind) {
  return kind == radio::QosKind::throughput ? "throughput" : "spectral_efficiency";
}

/// The status line and the validation log of both trainings, which run side by side.
class Desk {
 public:
  explicit Desk(std::filesystem::path log) : log_(std::move(log)) {}

  void progress(std::size_t side, const std::string& phase, double share) {
    const std::lock_guard lock(mutex_);
    status_.at(side) = fmt::format("{}: {} {:.0f} %", key_of(kinds.at(side)), phase, 100.0 * share);
    StatusLine::of_process().show(status_[0] + (status_[0].empty() || status_[1].empty() ? "" : "    ") + status_[1]);
  }

  /// Takes all lines of one side; the last one is new.
  void validated(std::size_t side, const std::vector<std::string>& lines) {
    const std::lock_guard lock(mutex_);
    if (lines.empty()) return;
    lines_.at(side) = lines;
    StatusLine::of_process().print(lines.back());
    std::string text;
    for (const auto& of_side : lines_)
      for (const std::string& line : of_side) text += line + '\n';
    write_file(log_, text);
  }

  void finished(std::size_t side) {
    const std::lock_guard lock(mutex_);
    status_.at(side).clear();
  }

 private:
  std::filesystem::path log_;
  std::mutex mutex_;
  std::array<std::string, kinds.size()> status_;
  std::array<std::vector<std::string>, kinds.size()> lines_;
};

std::filesystem::path checkpoint_of(const TrainOptions& options, radio::QosKind kind) {
  return fmt::format("{}.{}.checkpoint", options.out.string(), key_of(kind));
}

/// Trains the network of one side, from its checkpoint if there is one.
std::vector<float> train_side(const TrainOptions& options, std::size_t side, const Parameters& settings,
                              unsigned threads, Desk& desk, const std::atomic<bool>& interrupted) {
  const std::filesystem::path checkpoint = checkpoint_of(options, kinds.at(side));
  const train::Watch watch{
      [&](const std::string& phase, double share) { desk.progress(side, phase, share); },
      [&] { return interrupted.load(); },
  };
  train::Trainer trainer(kinds.at(side), settings, threads, watch);
  if (std::filesystem::exists(checkpoint)) {
    try {
      trainer.restore_state(read_file(checkpoint, largest_checkpoint_bytes));
    } catch (const IntegrityError& error) {
      throw InputError(
          "{}: cannot go on from this checkpoint: {}. It may be of another configuration: delete it to "
          "train from the start, or use another --out",
          checkpoint.string(), error.what());
    }
    StatusLine::of_process().print(fmt::format("{}: goes on from {}", key_of(kinds.at(side)), checkpoint.string()));
    desk.validated(side, trainer.validation_log());
  }
  while (!trainer.finished()) {
    trainer.train_round();
    write_file(checkpoint, trainer.save_state());
    desk.validated(side, trainer.validation_log());
  }
  desk.finished(side);
  return trainer.best_weights();
}

int train_pretrained(const TrainOptions& options) {
  const train::Config config = train::read_config(options.config);
  if (!options.out.parent_path().empty() && !std::filesystem::is_directory(options.out.parent_path()))
    throw InputError("{}: its folder does not exist; create it first", options.out.string());
  const std::atomic<bool>& interrupted = note_interrupts();
  Desk desk(options.out.string() + ".log");
  agents::PretrainedModel model;
  // Fitting uses one thread, so the two networks are trained side by side.
  const unsigned sides = std::min(options.threads, 2U);
  try {
    train::for_each_item(kinds.size(), sides, [&](unsigned /*thread*/, std::size_t side) {
      const Parameters& settings = side == 0 ? config.spectral_efficiency : config.throughput;
      auto& network = side == 0 ? model.spectral_efficiency : model.throughput;
      network.hidden_width = static_cast<std::size_t>(settings.integer("hidden_width"));
      network.weights = train_side(options, side, settings, options.threads / sides, desk, interrupted);
    });
  } catch (const train::Interrupted&) {
    StatusLine::of_process().finish();
    StatusLine::of_process().print("Interrupted. The same command goes on after the last round that was finished.");
    return exit_interrupted;
  }
  StatusLine::of_process().finish();
  model.training_config = config.canonical().dump();
  const std::string bytes = model.to_bytes();
  write_file(options.out, bytes);
  write_file(options.out.string() + ".sha256",
             fmt::format("{}  {}\n", sha256_hex(bytes), options.out.filename().string()));
  for (const radio::QosKind kind : kinds) std::filesystem::remove(checkpoint_of(options, kind));
  fmt::print("{}: {} bytes, SHA-256 {}\n", options.out.string(), bytes.size(), sha256_hex(bytes));
  return exit_ok;
}

}  // namespace

void add_train(CLI::App& app, Job& job) {
  auto* command = app.add_subcommand("train", "Train a network that is then shipped and flown without learning");
  command->require_subcommand(1);
  auto* pretrained = command->add_subcommand(
      "pretrained",
      "Train the model of agent 'pretrained' on generated worlds; stopped or killed, the same command goes on");
  auto options = std::make_shared<TrainOptions>();
  pretrained->add_option("--config", options->config, "Training configuration, JSON")->required();
  pretrained
      ->add_option("--out", options->out,
                   "Model file to write; beside it its SHA-256, the validation log and, until it "
                   "is finished, checkpoints")
      ->required();
  pretrained->add_option("--threads", options->threads, "Threads; the result is the same for any number [one per core]")
      ->check(runtime::whole_number(1, 1'024));
  pretrained->callback([options, &job] { job = [options] { return train_pretrained(*options); }; });
}

}  // namespace aloft::cli
