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

/// What one look at this machine found.
struct Finding {
  std::string check;  ///< e.g. "discovery"
  State state = State::ok;
  std::string text;    ///< what is the case
  std::string advice;  ///< what to do; empty if all is well
};

/// Space where the results go: problem under 100 MB, warning under 1 GB; a problem too if nothing can be written there.
[[nodiscard]] Finding check_results(const std::filesystem::path& dir);
/// Room in shared memory, which other programs on Fast DDS die without.
[[nodiscard]] Finding check_shared_memory(const std::filesystem::path& dir);
/// What killed processes left there; `clean`: removes it.
[[nodiscard]] Finding check_leftovers(const std::filesystem::path& dir, bool clean);
/// The kernel's largest socket buffers, in bytes, against what every process asks for.
[[nodiscard]] Finding check_socket_buffers(std::uint64_t receive_max, std::uint64_t send_max);
/// The same, read from the kernel.
[[nodiscard]] Finding check_socket_buffers();
/// How many processes there are in the domain, by the UDP ports in use (`ports`).
[[nodiscard]] Finding check_domain(int domain, const std::vector<int>& ports);
[[nodiscard]] std::vector<int> udp_ports_in_use();
/// Two participants of this process must find each other and talk.
[[nodiscard]] Finding check_discovery(const bus::BusOptions& place);
/// The time of day must be plausible and in step with other hosts, and time must not go backwards.
[[nodiscard]] Finding check_clock();
/// Without AVX2 and FMA worlds and learners are slow, and learners fly otherwise. `kernels`: of
/// learn::available_paths().
[[nodiscard]] Finding check_cpu(std::string_view kernels);
/// The same, of this CPU.
[[nodiscard]] Finding check_cpu();
/// The keys of all roles of which there is a folder.
[[nodiscard]] std::vector<Finding> check_keys(const std::filesystem::path& dir);

}  // namespace aloft::doctor
