#pragma once

#include "common/bus/wire.hpp"

namespace aloft::bus {

/// The limits of the wire beyond what IDL can say: sequence bounds, ranges, finite numbers, known enumerators.
/// Checked before every write and after every read; null if the sample is good, else what is wrong with it.
[[nodiscard]] const char* validate(const wire::RunControl& sample) noexcept;
[[nodiscard]] const char* validate(const wire::TrialAssignment& sample) noexcept;
[[nodiscard]] const char* validate(const wire::WorkerStatus& sample) noexcept;
[[nodiscard]] const char* validate(const wire::RunStatus& sample) noexcept;
[[nodiscard]] const char* validate(const wire::EpisodeRecord& sample) noexcept;
[[nodiscard]] const char* validate(const wire::EpisodeStored& sample) noexcept;
[[nodiscard]] const char* validate(const wire::RecordRefused& sample) noexcept;
[[nodiscard]] const char* validate(const wire::FlightMemory& sample) noexcept;
[[nodiscard]] const char* validate(const wire::MemoryRequest& sample) noexcept;
[[nodiscard]] const char* validate(const wire::StoredMemory& sample) noexcept;
[[nodiscard]] const char* validate(const wire::CollectorStatus& sample) noexcept;
[[nodiscard]] const char* validate(const wire::World& sample) noexcept;
[[nodiscard]] const char* validate(const wire::ChannelReport& sample) noexcept;
[[nodiscard]] const char* validate(const wire::HeightCommand& sample) noexcept;
[[nodiscard]] const char* validate(const wire::ReportFollowed& sample) noexcept;
[[nodiscard]] const char* validate(const wire::SwapRequest& sample) noexcept;
[[nodiscard]] const char* validate(const wire::SwapReply& sample) noexcept;
[[nodiscard]] const char* validate(const wire::AgentStatus& sample) noexcept;
[[nodiscard]] const char* validate(const wire::HeightProfile& sample) noexcept;

}  // namespace aloft::bus
