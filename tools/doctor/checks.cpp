#include "tools/doctor/checks.hpp"

#include <fmt/format.h>
#include <sys/statvfs.h>
#include <sys/timex.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <ctime>
#include <fstream>
#include <set>
#include <sstream>

#include "common/base/error.hpp"
#include "common/base/plain_text.hpp"
#include "common/bus/endpoint.hpp"
#include "common/bus/waiter.hpp"
#include "common/learn/network.hpp"
#include "common/security/keys.hpp"
#include "tools/doctor/leftovers.hpp"

namespace aloft::doctor {
namespace {

namespace fs = std::filesystem;
using namespace std::chrono_literals;

constexpr std::uint64_t megabyte = 1U << 20U;
constexpr std::uint64_t disk_problem_bytes = 100 * megabyte;
constexpr std::uint64_t disk_warning_bytes = 1024 * megabyte;
constexpr std::uint64_t shared_memory_warning_bytes = 64 * megabyte;
constexpr std::uint64_t socket_buffer_bytes = 4 * megabyte;
constexpr auto discovery_limit = 5s;
// RTPS 2.2, 9.6.1.1: domain d has 250 ports from 7400 + 250 d on; from the 10th on, each participant uses two.
constexpr int first_port = 7400;
constexpr int ports_per_domain = 250;
constexpr int participants_offset = 10;
constexpr int participants_max = (ports_per_domain - participants_offset) / 2;
constexpr int participants_warning = 90;

std::string size_text(std::uint64_t bytes) {
  const double gigabytes = static_cast<double>(bytes) / (1024.0 * megabyte);
  return gigabytes >= 1.0 ? fmt::format("{:.1f} GB", gigabytes) : fmt::format("{} MB", bytes / megabyte);
}

std::uint64_t free_bytes(const fs::path& dir) {
  struct statvfs facts {};
  return statvfs(dir.c_str(), &facts) == 0 ? std::uint64_t{facts.f_bavail} * facts.f_frsize : 0;
}

std::uint64_t number_in(const fs::path& file) {
  std::uint64_t value = 0;
  std::ifstream(file) >> value;
  return value;
}

Finding clock_problem(State state, std::string text) {
  return {"clock", state, std::move(text), "set it, and keep it in step: timedatectl set-ntp true"};
}

}  // namespace

const char* to_text(State state) noexcept {
  return state == State::ok ? "ok" : state == State::warning ? "warning" : "problem";
}

Finding check_results(const fs::path& dir) {
  fs::path there = fs::absolute(dir);
  while (!fs::exists(there) && there.has_relative_path()) there = there.parent_path();
  Finding finding{"results", State::ok, "", ""};
  if (!fs::is_directory(there) || access(there.c_str(), W_OK | X_OK) != 0) {
    finding.state = State::problem;
    finding.text = fmt::format("{} cannot be written", there.string());
    finding.advice = "choose another folder with --out, or change its owner or mode";
    return finding;
  }
  const std::uint64_t bytes = free_bytes(there);
  finding.text = fmt::format("{} can be written, {} free", there.string(), size_text(bytes));
  if (bytes >= disk_warning_bytes) return finding;
  finding.state = bytes < disk_problem_bytes ? State::problem : State::warning;
  finding.advice = "free some space: 1,000 flights of 100 steps take about 10 MB; a run pauses when the disk is full";
  return finding;
}

Finding check_middleware() {
  Finding finding{"middleware", State::ok, bus::middleware(), ""};
  for (const char* name : {"FASTRTPS_DEFAULT_PROFILES_FILE", "FASTDDS_DEFAULT_PROFILES_FILE"}) {
    const char* const file = std::getenv(name);
    if (file == nullptr) continue;
    finding.state = State::warning;
    finding.text += fmt::format("; {} names {}", name, plain_text(file));
    finding.advice =
        "unset it where Aloft is started: Aloft makes all settings itself, and such a file can change them";
  }
  return finding;
}

Finding check_shared_memory(const fs::path& dir) {
  const std::uint64_t bytes = free_bytes(dir);
  Finding finding{"shared memory", State::ok, fmt::format("{} free in {}", size_text(bytes), dir.string()), ""};
  if (bytes >= shared_memory_warning_bytes) return finding;
  finding.state = State::warning;
  finding.advice = "Aloft does not use it, but other programs on Fast DDS end when it is full; see `ls -l` there";
  return finding;
}

Finding check_leftovers(const fs::path& dir, bool clean) {
  const std::vector<Leftover> leftovers = find_leftovers(dir);
  std::uint64_t bytes = 0;
  for (const Leftover& leftover : leftovers) bytes += leftover.bytes;
  Finding finding{"leftovers", State::ok, fmt::format("nothing of killed processes in {}", dir.string()), ""};
  if (leftovers.empty()) return finding;
  finding.text = fmt::format("{} segments ({}) of killed processes of yours in {}", leftovers.size(), size_text(bytes),
                             dir.string());
  if (clean) {
    finding.text += fmt::format("; removed {}", remove_leftovers(leftovers));
    return finding;
  }
  finding.state = State::warning;
  finding.advice = "aloft doctor --clean removes them, and nothing else";
  return finding;
}

Finding check_socket_buffers(std::uint64_t receive_max, std::uint64_t send_max) {
  Finding finding{"socket buffers", State::ok,
                  fmt::format("at most {} KB to receive, {} KB to send", receive_max / 1024, send_max / 1024), ""};
  if (std::min(receive_max, send_max) >= socket_buffer_bytes) return finding;
  finding.state = State::warning;
  finding.text += fmt::format("; processes ask for {} KB", socket_buffer_bytes / 1024);
  finding.advice =
      fmt::format("large samples get lost and are sent again: sysctl -w net.core.rmem_max={0} net.core.wmem_max={0}",
                  socket_buffer_bytes);
  return finding;
}

Finding check_socket_buffers() {
  return check_socket_buffers(number_in("/proc/sys/net/core/rmem_max"), number_in("/proc/sys/net/core/wmem_max"));
}

std::vector<int> udp_ports_in_use() {
  std::set<int> ports;
  std::ifstream table("/proc/net/udp");
  std::string line;
  std::getline(table, line);
  while (std::getline(table, line)) {
    // "  12: 0100007F:1CF2 ...": address and port in hexadecimal digits
    std::istringstream fields(line);
    std::string slot;
    std::string local;
    if (fields >> slot >> local && local.find(':') != std::string::npos)
      ports.insert(std::stoi(local.substr(local.find(':') + 1), nullptr, 16));
  }
  return {ports.begin(), ports.end()};
}

Finding check_domain(int domain, const std::vector<int>& ports) {
  const int first = first_port + ports_per_domain * domain + participants_offset;
  std::set<int> participants;
  for (const int port : ports)
    if (port >= first && port < first + 2 * participants_max) participants.insert((port - first) / 2);
  const auto count = static_cast<int>(participants.size());
  Finding finding{"domain", State::ok,
                  fmt::format("{} processes use ports of domain {} (of {})", count, domain, participants_max), ""};
  if (count < participants_warning) return finding;
  finding.state = count >= participants_max ? State::problem : State::warning;
  finding.advice = "start further runs in another --domain; at most 101";
  return finding;
}

Finding check_discovery(const bus::BusOptions& place) {
  Finding finding{"discovery", State::problem, "", ""};
  try {
    bus::BusOptions options = place;
    options.run = fmt::format("doctor.{}", getpid());
    options.secure.clear();  // about the network alone
    const bus::Participant first(options);
    const bus::Participant second(options);
    bus::Reader<wire::RunStatus> reader(second);
    const auto start = std::chrono::steady_clock::now();
    bus::Writer<wire::RunStatus> writer(first);
    writer.write(wire::RunStatus());
    wire::RunStatus sample;
    bus::Waiter waiter;
    waiter.add(reader);
    while (std::chrono::steady_clock::now() - start < discovery_limit) {
      waiter.wait(50ms);
      if (!reader.take(sample)) continue;
      const std::chrono::duration<double, std::milli> took = std::chrono::steady_clock::now() - start;
      finding.state = State::ok;
      finding.text = fmt::format("two participants on {} heard each other after {:.0f} ms",
                                 fmt::join(place.interfaces, ", "), took.count());
      return finding;
    }
    finding.text = fmt::format("two participants on {} did not hear each other within {} s",
                               fmt::join(place.interfaces, ", "), discovery_limit.count());
    finding.advice =
        "let multicast and UDP ports 7400 to 32900 pass on this interface (firewall; ip link set dev lo multicast on)";
  } catch (const std::exception& error) {
    finding.text = error.what();
    finding.advice = "try another --domain or --interface";
  }
  return finding;
}

Finding check_clock() {
  constexpr std::time_t plausible = 1'735'689'600;  // 2025-01-01
  if (std::time(nullptr) < plausible) return clock_problem(State::problem, "the time of day is before 2025");
  auto last = std::chrono::steady_clock::now();
  const auto steady_start = last;
  const auto day_start = std::chrono::system_clock::now();
  while (last - steady_start < 100ms) {
    const auto now = std::chrono::steady_clock::now();
    if (now < last) return clock_problem(State::problem, "time goes backwards");
    last = now;
  }
  const auto jump = (std::chrono::system_clock::now() - day_start) - (last - steady_start);
  if (jump > 50ms || jump < -50ms) return clock_problem(State::warning, "the time of day has just jumped");
  timex facts{};
  if (adjtimex(&facts) == TIME_ERROR || (facts.status & STA_UNSYNC) != 0)
    return clock_problem(State::warning,
                         "steady, but not kept in step with others (logs and certificates of several hosts need that)");
  return {"clock", State::ok, "steady and kept in step", ""};
}

Finding check_cpu(std::string_view kernels) {
  if (kernels != learn::path_name(learn::Path::portable)) return {"cpu", State::ok, fmt::format("has {}", kernels), ""};
  return {"cpu", State::warning,
          "has no AVX2 with FMA: worlds take seconds instead of milliseconds, learners' results differ from other "
          "machines'",
          "in a virtual machine, pass the host's CPU through (QEMU: -cpu host)"};
}

Finding check_cpu() {
  return check_cpu(learn::path_name(learn::available_paths().back()));
}

std::vector<Finding> check_keys(const fs::path& dir) {
  std::vector<Finding> findings;
  for (const security::Role role : security::all_roles) {
    const std::string name(security::to_text(role));
    if (!fs::exists(dir / name)) continue;
    try {
      (void)security::check_keys(dir, role);
      findings.push_back({"keys", State::ok, name + ": valid", ""});
    } catch (const InputError& error) {
      findings.push_back({"keys", State::problem, error.what(), ""});
    }
  }
  if (findings.empty())
    findings.push_back({"keys", State::problem, fmt::format("{} holds no keys of any role", dir.string()),
                        "make some: aloft keys init, then aloft keys issue"});
  return findings;
}

}  // namespace aloft::doctor
