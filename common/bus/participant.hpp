#pragma once

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "common/bus/guard/refusal.hpp"
#include "common/bus/topics.hpp"

namespace aloft::bus {

/// The number of processes that a domain has room for in any case: DDS has ports for 120 on a host, and a secured
/// process can begin 100 handshakes.
inline constexpr unsigned max_processes = 100;

/// Empty if `name` can be the name of a run or a worker; else the rule for such names, as a part of a message. Names
/// are parts of partitions, file names and logs.
[[nodiscard]] std::string name_objection(std::string_view name);

/// The middleware of this process, e.g. "Fast DDS 2.9.1".
[[nodiscard]] std::string middleware();

/// Why no process on this middleware can take part in a secured run; empty if it can.
[[nodiscard]] std::string secured_run_objection();

/// The place of a process on the bus.
struct BusOptions {
  std::string run = "default";  ///< partition of the run: see name_objection
  std::string worker;           ///< partition of the worker, e.g. "w0"; empty: coordinator, metrics, command line
  std::string process;          ///< for logs and discovery, e.g. "aloft-channel"
  int domain = 0;               ///< 0..101
  /// IPv4 addresses or names of interfaces to use; loopback only unless the user says otherwise.
  std::vector<std::string> interfaces{"127.0.0.1"};
  std::string discovery_server{};  ///< "HOST:PORT" of the server that introduces processes; empty: multicast
  bool serves_discovery = false;   ///< this process is that server
  /// Folder with the keys (common/security/keys.hpp); empty: neither authentication nor encryption.
  std::filesystem::path secure{};
  Role role = Role::observer;  ///< in a secured run
  /// A process that is silent for this long is forgotten; not in a secured run, and not with a discovery server.
  std::chrono::milliseconds lease{1500};
  bool guarded = true;  ///< false only where the guard's cost is measured (bench/bus_round_trip.cpp)
};

/// A process that stands still for longer than this is not accepted by its peers again, and must be restarted; nullopt:
/// it is accepted again after any time.
[[nodiscard]] std::optional<std::chrono::milliseconds> longest_standstill(const BusOptions& options) noexcept;

/// Samples of one topic that were refused in this process.
struct Drops {
  std::uint64_t malformed = 0;  ///< not the bytes of this type
  std::uint64_t invalid = 0;    ///< a value out of its range (validate.hpp)
  std::uint64_t foreign = 0;    ///< of another protocol version or experiment

  [[nodiscard]] std::uint64_t total() const noexcept { return malformed + invalid + foreign; }
};

/// One per process: its place on the bus. Writers and readers keep it alive as long as they need it.
class Participant {
 public:
  /// InputError if an option is out of range or not of this machine; std::runtime_error if the middleware refuses.
  explicit Participant(const BusOptions& options);

  [[nodiscard]] const BusOptions& options() const noexcept;
  /// Drops over all topics.
  [[nodiscard]] std::uint64_t drops() const;
  /// Datagrams that the guard kept from the middleware.
  [[nodiscard]] RefusalCounts refused() const;
  /// Names of the runs in this domain of which a process is known now, sorted; it takes up to 0.5 s to discover all.
  [[nodiscard]] std::vector<std::string> runs() const;
  /// The middleware of the processes of `run` that are known now: sorted, each one once, unverified. Processes that do
  /// not name it are left out.
  [[nodiscard]] std::vector<std::string> middleware_of(const std::string& run) const;
  /// Names and addresses of processes that may be back soon: silent for less than `patience` and not replaced, or back
  /// a moment ago, so that perhaps not all of their readers are known.
  [[nodiscard]] std::vector<std::string> absent(std::chrono::milliseconds patience) const;

  struct State;
  [[nodiscard]] const std::shared_ptr<State>& state() const noexcept { return state_; }

 private:
  std::shared_ptr<State> state_;
};

}  // namespace aloft::bus
