#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "common/bus/participant.hpp"

namespace aloft::doctor {

enum class State { ok, warning, problem };

[[nodiscard]] const char* to_text(State state) noexcept;

/// The result of one check of this machine.
struct Finding {
  std::string check;  ///< e.g. "discovery"
  State state = State::ok;
  std::string text;    ///< what was found
  std::string advice;  ///< what to do; empty if all is well
};

/// Space where the results go: problem under 100 MB, warning under 1 GB; a problem too if nothing can be written there.
[[nodiscard]] Finding check_results(const std::filesystem::path& dir);
/// Which middleware this is; a warning if the environment names a file of settings for it.
[[nodiscard]] Finding check_middleware();
/// Space in shared memory: other programs on Fast DDS crash when it is full.
[[nodiscard]] Finding check_shared_memory(const std::filesystem::path& dir);
/// Files that killed processes left in shared memory; `clean` removes them.
[[nodiscard]] Finding check_leftovers(const std::filesystem::path& dir, bool clean);
/// The kernel's largest socket buffers, in bytes, against what every process asks for.
[[nodiscard]] Finding check_socket_buffers(std::uint64_t receive_max, std::uint64_t send_max);
/// The same, read from the kernel.
[[nodiscard]] Finding check_socket_buffers();
/// Number of processes in the domain, from the UDP ports in use (`ports`).
[[nodiscard]] Finding check_domain(int domain, const std::vector<int>& ports);
[[nodiscard]] std::vector<int> udp_ports_in_use();
/// Two participants of this process must find each other and talk.
[[nodiscard]] Finding check_discovery(const bus::BusOptions& place);
/// The time of day must be plausible and in step with other hosts, and time must not go backwards.
[[nodiscard]] Finding check_clock();
/// Without AVX2 and FMA worlds and learners are slow, and learners give other results. `kernels`: a name of
/// learn::available_paths().
[[nodiscard]] Finding check_cpu(std::string_view kernels);
/// The same for this CPU.
[[nodiscard]] Finding check_cpu();
/// The keys of every role that has a folder.
[[nodiscard]] std::vector<Finding> check_keys(const std::filesystem::path& dir);

}  // namespace aloft::doctor
