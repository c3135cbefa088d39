#pragma once

#include <cstddef>
#include <cstdint>

/// Upper bounds that hold both in files and on the wire, so that whatever an experiment can contain can also be sent.
/// The bounds in idl/*.idl repeat some of them; a test compares them.
namespace aloft::limits {

inline constexpr std::size_t json_bytes = 8U << 20U;
inline constexpr std::size_t json_depth = 32;  ///< objects and lists within each other

inline constexpr std::size_t name_bytes = 64;
inline constexpr std::size_t message_bytes = 512;
inline constexpr std::size_t experiment_bytes = 1U << 20U;   ///< in canonical form
inline constexpr std::size_t radio_json_bytes = 64U << 10U;  ///< parameters of a world
inline constexpr std::size_t trace_bytes = 4U << 20U;
inline constexpr std::size_t memory_bytes = 16U << 20U;  ///< that an agent keeps from flight to flight

inline constexpr std::size_t agents = 64;               ///< of an experiment
inline constexpr std::uint64_t trials = 10'000'000;     ///< of all conditions of an experiment together
inline constexpr std::size_t lanes = 16;                ///< trials that a worker flies at a time
inline constexpr std::size_t leases = 64;               ///< of a worker
inline constexpr std::size_t failures_told = 64;        ///< that a worker reports
inline constexpr std::size_t agents_told = 64;          ///< that a worker reports
inline constexpr std::size_t workers = 1024;            ///< of a run
inline constexpr std::size_t refused_collectors = 16;   ///< that the coordinator names
inline constexpr std::size_t streams = agents * lanes;  ///< flights at a time on one worker

inline constexpr std::uint32_t steps = 16'384;          ///< of a flight
inline constexpr std::uint32_t heights = 4'096;         ///< of a world
inline constexpr std::uint32_t base_stations = 65'536;  ///< of a city: fading numbers pairs of them in 32 bits
inline constexpr std::size_t cells = 1U << 20U;  ///< buildings of a city; steps times heights of a measured flight
inline constexpr std::size_t neighbours = 5;     ///< in a report

inline constexpr double height_m = 100e3;  ///< of anything; also below zero
inline constexpr double height_step_min_m = 1e-3;
inline constexpr double distance_m = 1e6;  ///< from the city's centre
inline constexpr double level_db = 1e4;    ///< an SINR, with either sign
inline constexpr double quality = 1e9;     ///< bit/s/Hz or kbit/s, with either sign
inline constexpr double reward = 1e12;     ///< quality minus all that a step can cost

}  // namespace aloft::limits
