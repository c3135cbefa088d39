#pragma once

#include <fastdds/rtps/transport/TransportDescriptorInterface.h>

#include <cstddef>
#include <memory>

namespace aloft::bus {

/// `below`, made fit for a secured run. Two things that Fast DDS 2.9.1 does not do by itself:
/// - What arrives is handled one message at a time. The receiving threads share unprotected data while they
///   authenticate others (upstream pull requests 3362 and 4188): two who are met at the same moment would be mixed up,
///   and one of them would never be answered.
/// - What arrives in clear text is dropped, except introductions (see permitted_in_secured_run). The middleware would
///   take a forged sample from anybody who writes the address of a known writer on it.
[[nodiscard]] std::shared_ptr<eprosima::fastdds::rtps::TransportDescriptorInterface> for_secured_run(
    std::shared_ptr<eprosima::fastdds::rtps::TransportDescriptorInterface> below);

/// Whether everything in an RTPS message is encrypted, or belongs to discovering and authenticating participants, which
/// cannot be.
[[nodiscard]] bool permitted_in_secured_run(const unsigned char* bytes, std::size_t size) noexcept;

}  // namespace aloft::bus
