#pragma once

// Inside common/bus only: the other participants of the domain.

#include <fastdds/dds/domain/DomainParticipantListener.hpp>
#include <map>
#include <mutex>
#include <string>
#include <string_view>
#include <vector>

#include "common/bus/middleware/rediscovery.hpp"

namespace aloft::bus {

/// Keeps track of the other participants; the middleware calls it from its own threads. In a secured run it logs each
/// participant that the middleware refuses, once.
class Neighbourhood : public eprosima::fastdds::dds::DomainParticipantListener {
 public:
  /// The authority whose certificates are accepted (KeyFiles::authority); empty: the run is not secured.
  void expect_authority(std::string name) { authority_ = std::move(name); }
  /// Sets the thread to notify when a peer is back or asks for our endpoints; to be called before discovery begins.
  void tell(RediscoveryThread& thread) { thread_ = &thread; }
  [[nodiscard]] Rediscovery& rediscovery() noexcept { return rediscovery_; }
  /// Names of the runs of which a writer is known, sorted.
  [[nodiscard]] std::vector<std::string> runs() const;
  /// "'aloft-channel-w0' at 10.0.0.7", unverified.
  [[nodiscard]] static std::string name_of(const eprosima::fastrtps::rtps::GuidPrefix_t& participant);
  /// The same by the id that the middleware writes in its log.
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

/// The partition of every run begins with this.
inline constexpr std::string_view partition_root = "aloft/";

}  // namespace aloft::bus
