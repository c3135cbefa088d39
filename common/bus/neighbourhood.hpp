#pragma once

// Inside common/bus only: who else is in the domain.

#include <fastdds/dds/domain/DomainParticipantListener.hpp>
#include <map>
#include <mutex>
#include <string>
#include <string_view>
#include <vector>

#include "common/bus/middleware/rediscovery.hpp"

namespace aloft::bus {

/// Notes who else is there; the middleware calls it from its own threads. In a secured run it names in the log whom the
/// middleware refuses, once each.
class Neighbourhood : public eprosima::fastdds::dds::DomainParticipantListener {
 public:
  /// Whose certificates are taken (KeyFiles::authority); empty: the run is not secured.
  void expect_authority(std::string name) { authority_ = std::move(name); }
  /// Is told when somebody is back or asks for our endpoints. To be set beforehand.
  void tell(RediscoveryThread& thread) { thread_ = &thread; }
  [[nodiscard]] Rediscovery& rediscovery() noexcept { return rediscovery_; }
  /// Names of the runs of which a writer is known, sorted.
  [[nodiscard]] std::vector<std::string> runs() const;
  /// "'aloft-channel-w0' at 10.0.0.7", as it says.
  [[nodiscard]] static std::string name_of(const eprosima::fastrtps::rtps::GuidPrefix_t& participant);
  /// By the text that the middleware writes for a participant in its log.
  [[nodiscard]] static std::string name_of(const std::string& participant);

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
  RediscoveryThread* thread_ = nullptr;
  Rediscovery rediscovery_;
  mutable std::mutex mutex_;
  std::map<eprosima::fastrtps::rtps::GUID_t, std::string> runs_;  // by writer
};

/// The partition of a run begins with it.
inline constexpr std::string_view partition_root = "aloft/";

}  // namespace aloft::bus
