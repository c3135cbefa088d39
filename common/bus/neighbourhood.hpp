#pragma once

// Inside common/bus only: who else is in the domain.

#include <fastdds/dds/domain/DomainParticipantListener.hpp>
#include <functional>
#include <map>
#include <mutex>
#include <string>
#include <string_view>
#include <vector>

#include "common/bus/reunion.hpp"

namespace aloft::bus {

/// Notes who else is there; the middleware calls it from its own threads. In a secured run it names in the log whom the
/// middleware refuses, once each.
class Neighbourhood : public eprosima::fastdds::dds::DomainParticipantListener {
 public:
  /// Whose certificates are taken (KeyFiles::authority); empty: the run is not secured.
  void expect_authority(std::string name) { authority_ = std::move(name); }
  /// Called when somebody is back whose endpoints may be missing, and when somebody asks us for ours (true): from the
  /// middleware's threads, so it must not call the middleware. To be set beforehand.
  void on_reunion(std::function<void(bool asks_us)> callback) { on_reunion_ = std::move(callback); }
  [[nodiscard]] Reunion& reunion() noexcept { return reunion_; }
  /// Names of the runs of which a writer is known, sorted.
  [[nodiscard]] std::vector<std::string> runs() const;
  /// "'aloft-channel-w0' at 10.0.0.7", as it says.
  [[nodiscard]] static std::string name_of(const eprosima::fastrtps::rtps::GuidPrefix_t& participant);

  void on_participant_discovery(eprosima::fastdds::dds::DomainParticipant* participant,
                                eprosima::fastrtps::rtps::ParticipantDiscoveryInfo&& info) override;
  void onParticipantAuthentication(eprosima::fastdds::dds::DomainParticipant* participant,
                                   eprosima::fastrtps::rtps::ParticipantAuthenticationInfo&& info) override;
  void on_publisher_discovery(eprosima::fastdds::dds::DomainParticipant* participant,
                              eprosima::fastrtps::rtps::WriterDiscoveryInfo&& info) override;
  void on_subscriber_discovery(eprosima::fastdds::dds::DomainParticipant* participant,
                               eprosima::fastrtps::rtps::ReaderDiscoveryInfo&& info) override;

 private:
  std::string authority_;
  std::function<void(bool asks_us)> on_reunion_;
  Reunion reunion_;
  mutable std::mutex mutex_;
  std::map<eprosima::fastrtps::rtps::GUID_t, std::string> runs_;  // by writer
};

/// The partition of a run begins with it.
inline constexpr std::string_view partition_root = "aloft/";

/// What a message of the middleware says about a topic that a participant may not use, in words that name it; empty if
/// the message is about something else. The middleware tells of such refusals by its log alone.
[[nodiscard]] std::string refusal_in_words(const std::string& message);

}  // namespace aloft::bus
