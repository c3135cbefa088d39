#include <fmt/format.h>
#include <unistd.h>

#include <cstdio>
#include <nlohmann/json.hpp>

#include "common/base/error.hpp"
#include "common/base/terminal.hpp"
#include "common/base/text_layout.hpp"
#include "services/runtime/bus_flags.hpp"
#include "tools/aloft/commands.hpp"
#include "tools/doctor/checks.hpp"

namespace aloft::cli {
namespace {

using doctor::Finding;
using doctor::State;

constexpr const char* shared_memory_dir = "/dev/shm";

struct DoctorOptions {
  bus::BusOptions bus;
  std::filesystem::path results = "results";
  bool clean = false;
  std::string format;
};

std::vector<Finding> examine(const DoctorOptions& options) {
  std::vector<Finding> findings{doctor::check_results(options.results),
                                doctor::check_clock(),
                                doctor::check_cpu(),
                                doctor::check_middleware(),
                                doctor::check_socket_buffers(),
                                doctor::check_domain(options.bus.domain, doctor::udp_ports_in_use()),
                                doctor::check_discovery(options.bus),
                                doctor::check_shared_memory(shared_memory_dir),
                                doctor::check_leftovers(shared_memory_dir, options.clean)};
  if (!options.bus.secure.empty())
    for (Finding& finding : doctor::check_keys(options.bus.secure)) findings.push_back(std::move(finding));
  return findings;
}

void print_json(const std::vector<Finding>& findings, State worst) {
  nlohmann::ordered_json checks = nlohmann::ordered_json::array();
  for (const Finding& finding : findings)
    checks.push_back({{"check", finding.check},
                      {"state", doctor::to_text(finding.state)},
                      {"text", finding.text},
                      {"advice", finding.advice}});
  fmt::print("{}\n", nlohmann::ordered_json{{"state", doctor::to_text(worst)}, {"checks", std::move(checks)}}.dump(2));
}

void print_text(const Finding& finding) {
  const std::size_t width = text_width(STDOUT_FILENO);
  const std::string heading = fmt::format("{:<8} {:<15} ", doctor::to_text(finding.state), finding.check);
  const std::string indent(heading.size(), ' ');
  fmt::print("{}", wrapped(finding.text, width, heading, indent));
  if (!finding.advice.empty()) fmt::print("{}", wrapped(finding.advice, width, indent + "-> ", indent + "   "));
}

int diagnose(const DoctorOptions& options) {
  const std::vector<Finding> findings = examine(options);
  State worst = State::ok;
  for (const Finding& finding : findings) worst = std::max(worst, finding.state);
  if (options.format == "json") {
    print_json(findings, worst);
  } else {
    for (const Finding& finding : findings) print_text(finding);
  }
  std::fflush(stdout);
  return worst == State::problem ? exit_failure : exit_ok;
}

}  // namespace

void add_doctor(CLI::App& app, Job& job) {
  auto* command = app.add_subcommand(
      "doctor",
      "Check this machine: disk, clock, CPU, network, discovery, leftovers of killed processes; says what to do");
  auto options = std::make_shared<DoctorOptions>();
  options->bus.process = "aloft-doctor";
  runtime::add_bus_flags(*command, options->bus);
  command->add_option("--out", options->results, "Folder where results shall go")->capture_default_str();
  command->add_flag("--clean", options->clean,
                    "Remove shared memory that killed processes of this user left; nothing of the living or of others");
  add_format(*command, options->format, {"text", "json"});
  command->callback([options, &job] { job = [options] { return diagnose(*options); }; });
}

}  // namespace aloft::cli
