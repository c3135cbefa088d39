#include "common/security/keys.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cstdio>

#include "common/base/error.hpp"
#include "common/bus/topics.hpp"
#include "services/runtime/flag_checks.hpp"
#include "tools/aloft/commands.hpp"

namespace aloft::cli {
namespace {

struct InitOptions {
  std::filesystem::path dir;
  int days = 3650;
};

struct IssueOptions {
  std::filesystem::path dir;
  std::vector<std::string> roles;
  std::string name;
  int days = 365;
  std::filesystem::path out;
};

constexpr int max_days = 36500;

std::vector<std::string> role_names() {
  std::vector<std::string> names;
  names.reserve(std::size(security::all_roles));
  for (const security::Role role : security::all_roles) names.emplace_back(security::to_text(role));
  return names;
}

int init(const InitOptions& options) {
  security::init_keys(options.dir, options.days);
  fmt::print("Made an authority in {0}, valid for {1} days. Next: aloft keys issue {0} all\n", options.dir.string(),
             options.days);
  return exit_ok;
}

int issue(const IssueOptions& options) {
  const std::filesystem::path out = options.out.empty() ? options.dir : options.out;
  const bool all = options.roles == std::vector<std::string>{"all"};
  for (const std::string& name : all ? role_names() : options.roles) {
    const security::Role role = security::role_from_text(name);
    security::issue_keys(options.dir,
                         {.role = role, .name = options.name.empty() ? name : options.name, .days = options.days},
                         bus::topic_rights(role), out);
    fmt::print("{}: key.pem, cert.pem and permissions.p7s, valid for {} days\n", (out / name).string(), options.days);
  }
  fmt::print(stderr, "Keep ca.key.pem to yourself; processes are started with --secure {} and do not need it.\n",
             out.string());
  return exit_ok;
}

void add_init(CLI::App& keys, Job& job) {
  auto* command = keys.add_subcommand("init", "Make a certificate authority in a new folder");
  auto options = std::make_shared<InitOptions>();
  command->add_option("dir", options->dir, "Folder of the authority")->required();
  command->add_option("--days", options->days, "How long it is valid")
      ->check(runtime::whole_number(1, max_days))
      ->capture_default_str();
  command->callback([options, &job] { job = [options] { return init(*options); }; });
}

void add_issue(CLI::App& keys, Job& job) {
  auto* command = keys.add_subcommand("issue", "Issue keys, a certificate and permissions for roles");
  auto options = std::make_shared<IssueOptions>();
  command->add_option("dir", options->dir, "Folder of the authority")->required();
  command->add_option("roles", options->roles, fmt::format("all, or some of: {}", fmt::join(role_names(), ", ")))
      ->required();
  command
      ->add_option("--name", options->name, "Whom they are for, e.g. the host; others see it in their logs [the role]")
      ->check(runtime::bus_name());
  command->add_option("--days", options->days, "How long they are valid")
      ->check(runtime::whole_number(1, max_days))
      ->capture_default_str();
  command->add_option("--out", options->out, "Folder to write them to, e.g. for another host [the authority's]");
  command->callback([options, &job] { job = [options] { return issue(*options); }; });
}

}  // namespace

void add_keys(CLI::App& app, Job& job) {
  auto* command =
      app.add_subcommand("keys", "Make the keys and permissions of a secured run (--secure); see SECURITY.md");
  command->require_subcommand(1);
  add_init(*command, job);
  add_issue(*command, job);
}

}  // namespace aloft::cli
