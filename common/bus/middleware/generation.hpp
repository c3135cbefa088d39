#pragma once

// The two generations of Fast DDS under one set of names: 2.9 (Debian 12) and 3.x (Debian 13: 3.1.2). No repair.
// Nothing else in the sources asks which one it is; which versions are supported is in cmake/AloftMiddleware.cmake.
//
// Inside common/bus only.

#if __has_include(<fastdds/config.hpp>)
#define ALOFT_FAST_DDS_3 1
#include <fastdds/LibrarySettings.hpp>
#include <fastdds/config.hpp>
#include <fastdds/dds/core/ReturnCode.hpp>
#include <fastdds/dds/core/Time_t.hpp>
#include <fastdds/rtps/builtin/data/ParticipantBuiltinTopicData.hpp>
#include <fastdds/rtps/common/Guid.hpp>
#include <fastdds/rtps/common/Locator.hpp>
#include <fastdds/rtps/common/SerializedPayload.hpp>
#include <fastdds/rtps/transport/ChainingTransport.hpp>
#include <fastdds/rtps/transport/ChainingTransportDescriptor.hpp>
#include <fastdds/rtps/transport/NetworkBuffer.hpp>
#include <fastdds/rtps/transport/SenderResource.hpp>
#include <fastdds/rtps/transport/UDPv4TransportDescriptor.hpp>
#include <fastdds/utils/IPLocator.hpp>
#else
#define ALOFT_FAST_DDS_3 0
#include <fastdds/rtps/common/Guid.h>
#include <fastdds/rtps/common/Locator.h>
#include <fastdds/rtps/common/SerializedPayload.h>
#include <fastdds/rtps/network/SenderResource.h>
#include <fastdds/rtps/transport/ChainingTransport.h>
#include <fastdds/rtps/transport/ChainingTransportDescriptor.h>
#include <fastdds/rtps/transport/UDPv4TransportDescriptor.h>
#include <fastrtps/config.h>
#include <fastrtps/qos/QosPolicies.h>
#include <fastrtps/types/TypesBase.h>
#include <fastrtps/utils/IPLocator.h>
#include <fastrtps/xmlparser/XMLProfileManager.h>
#endif

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <fastdds/dds/domain/DomainParticipantFactory.hpp>
#include <fastdds/dds/domain/DomainParticipantListener.hpp>
#include <fastdds/dds/domain/qos/DomainParticipantQos.hpp>
#include <fastdds/dds/publisher/qos/DataWriterQos.hpp>
#include <functional>
#include <sstream>
#include <string>
#include <vector>

namespace aloft::bus {

namespace dds = eprosima::fastdds::dds;

#if ALOFT_FAST_DDS_3
namespace rtps = eprosima::fastdds::rtps;
using Duration = dds::Duration_t;
using PeerData = rtps::ParticipantBuiltinTopicData;
inline constexpr const char* middleware_version = FASTDDS_VERSION_STR;
#else
namespace rtps {
using namespace eprosima::fastdds::rtps;
using namespace eprosima::fastrtps::rtps;
// Names that both have, as the same class; clang takes them for two.
using eprosima::fastdds::rtps::LocatorsIterator;
using eprosima::fastdds::rtps::TransportDescriptorInterface;
using eprosima::fastdds::rtps::TransportInterface;
}  // namespace rtps
using Duration = eprosima::fastrtps::Duration_t;
using PeerData = rtps::ParticipantProxyData;
inline constexpr const char* middleware_version = FASTRTPS_VERSION_STR;
#endif

// --- results ---

/// Whether a call of the middleware did its work. Its write() says so by true in 2.x and by 0 in 3.x.
#if ALOFT_FAST_DDS_3
[[nodiscard]] inline bool succeeded(dds::ReturnCode_t code) noexcept {
  return code == dds::RETCODE_OK;
}
bool succeeded(bool) = delete;
#else
[[nodiscard]] inline bool succeeded(bool done) noexcept {
  return done;
}
[[nodiscard]] inline bool succeeded(const eprosima::fastrtps::types::ReturnCode_t& code) noexcept {
  return code == eprosima::fastrtps::types::ReturnCode_t::RETCODE_OK;
}
#endif

// --- settings ---

/// To be called before the first participant is made: samples take the network within a process, too.
inline void switch_off_intraprocess_delivery() {
#if ALOFT_FAST_DDS_3
  eprosima::fastdds::LibrarySettings library;
  library.intraprocess_delivery = eprosima::fastdds::INTRAPROCESS_OFF;
  static_cast<void>(dds::DomainParticipantFactory::get_instance()->set_library_settings(library));
#else
  eprosima::fastrtps::LibrarySettingsAttributes library;
  library.intraprocess_delivery = eprosima::fastrtps::INTRAPROCESS_OFF;
  eprosima::fastrtps::xmlparser::XMLProfileManager::library_settings(library);
#endif
}

/// 3.x: no service that tells others about types, in clear text also in secured runs. 2.x: has none unless asked.
inline void switch_off_type_lookup([[maybe_unused]] dds::DomainParticipantQos& qos) {
#if ALOFT_FAST_DDS_3
  qos.properties().properties().emplace_back("fastdds.type_propagation", "disabled");
#endif
}

[[nodiscard]] inline Duration& heartbeat_period(dds::RTPSReliableWriterQos& qos) noexcept {
#if ALOFT_FAST_DDS_3
  return qos.times.heartbeat_period;
#else
  return qos.times.heartbeatPeriod;
#endif
}

/// Makes a participant the discovery server at `locator`.
inline void serve_discovery(const rtps::Locator_t& locator, const char* server_prefix,
                            dds::WireProtocolConfigQos& wire) {
#if ALOFT_FAST_DDS_3
  wire.builtin.discovery_config.discoveryProtocol = rtps::DiscoveryProtocol::SERVER;
#else
  wire.builtin.discovery_config.discoveryProtocol = rtps::DiscoveryProtocol_t::SERVER;
#endif
  std::istringstream(server_prefix) >> wire.prefix;
  wire.builtin.metatrafficUnicastLocatorList.push_back(locator);
}

/// Makes a participant a client of the discovery server at `locator`. 2.x needs to know the server's prefix.
inline void ask_discovery_server(const rtps::Locator_t& locator, [[maybe_unused]] const char* server_prefix,
                                 dds::WireProtocolConfigQos& wire) {
  auto& discovery = wire.builtin.discovery_config;
#if ALOFT_FAST_DDS_3
  discovery.discoveryProtocol = rtps::DiscoveryProtocol::CLIENT;
  discovery.m_DiscoveryServers.push_back(locator);
#else
  discovery.discoveryProtocol = rtps::DiscoveryProtocol_t::CLIENT;
  rtps::RemoteServerAttributes server;
  server.ReadguidPrefix(server_prefix);
  server.metatrafficUnicastLocatorList.push_back(locator);
  discovery.m_DiscoveryServers.push_back(server);
#endif
}

// --- other participants ---

[[nodiscard]] inline const rtps::GuidPrefix_t& prefix_of(const PeerData& peer) noexcept {
#if ALOFT_FAST_DDS_3
  return peer.guid.guidPrefix;
#else
  return peer.m_guid.guidPrefix;
#endif
}

[[nodiscard]] inline std::string name_of(const PeerData& peer) {
#if ALOFT_FAST_DDS_3
  return peer.participant_name.to_string();
#else
  return peer.m_participantName.to_string();
#endif
}

[[nodiscard]] inline const std::vector<rtps::octet>& user_data_of(const PeerData& peer) noexcept {
#if ALOFT_FAST_DDS_3
  return peer.user_data.getValue();
#else
  return peer.m_userData.getValue();
#endif
}

/// What a process says of its certificate when it is discovered; nothing of it is verified.
struct ShownCertificate {
  bool shown = false;
  std::string subject;
  std::string authority;
};

/// 3.x does not pass it on; there no run is secured.
[[nodiscard]] inline ShownCertificate certificate_of([[maybe_unused]] const PeerData& peer) {
#if ALOFT_FAST_DDS_3
  return {};
#else
  const rtps::IdentityToken& token = peer.identity_token_;
  const auto property = [&](const char* name) {
    const std::string* value = rtps::DataHolderHelper::find_property_value(token, name);
    return value == nullptr ? "" : *value;
  };
  return {!token.class_id().empty(), property("dds.cert.sn"), property("dds.ca.sn")};
#endif
}

/// What the middleware reports about others, from its own threads.
class PeerListener : public dds::DomainParticipantListener {
 public:
  enum class Change : std::uint8_t { found, changed, left, silent };

  virtual void on_peer(Change change, const PeerData& peer) = 0;
  virtual void on_reader(dds::DomainParticipant& self, bool known, const rtps::GUID_t& reader,
                         const std::vector<rtps::octet>& user_data) = 0;
  virtual void on_writer(bool known, const rtps::GUID_t& writer, const std::vector<std::string>& partitions) = 0;

 private:
#if ALOFT_FAST_DDS_3
  void on_participant_discovery(dds::DomainParticipant* /*participant*/, rtps::ParticipantDiscoveryStatus status,
                                const PeerData& peer, bool& /*should_be_ignored*/) final {
    using Status = rtps::ParticipantDiscoveryStatus;
    if (status == Status::IGNORED_PARTICIPANT) return;
    on_peer(status == Status::DISCOVERED_PARTICIPANT ? Change::found
            : status == Status::REMOVED_PARTICIPANT  ? Change::left
            : status == Status::DROPPED_PARTICIPANT  ? Change::silent
                                                     : Change::changed,
            peer);
  }
  void on_data_reader_discovery(dds::DomainParticipant* participant, rtps::ReaderDiscoveryStatus status,
                                const rtps::SubscriptionBuiltinTopicData& reader, bool& /*should_be_ignored*/) final {
    if (status == rtps::ReaderDiscoveryStatus::IGNORED_READER) return;
    on_reader(*participant, status != rtps::ReaderDiscoveryStatus::REMOVED_READER, reader.guid,
              reader.user_data.getValue());
  }
  void on_data_writer_discovery(dds::DomainParticipant* /*participant*/, rtps::WriterDiscoveryStatus status,
                                const rtps::PublicationBuiltinTopicData& writer, bool& /*should_be_ignored*/) final {
    if (status == rtps::WriterDiscoveryStatus::IGNORED_WRITER) return;
    on_writer(status != rtps::WriterDiscoveryStatus::REMOVED_WRITER, writer.guid, writer.partition.getNames());
  }
#else
  void on_participant_discovery(dds::DomainParticipant* /*participant*/, rtps::ParticipantDiscoveryInfo&& info) final {
    using Info = rtps::ParticipantDiscoveryInfo;
    on_peer(info.status == Info::DISCOVERED_PARTICIPANT ? Change::found
            : info.status == Info::REMOVED_PARTICIPANT  ? Change::left
            : info.status == Info::DROPPED_PARTICIPANT  ? Change::silent
                                                        : Change::changed,
            info.info);
  }
  void on_subscriber_discovery(dds::DomainParticipant* participant, rtps::ReaderDiscoveryInfo&& reader) final {
    on_reader(*participant, reader.status != rtps::ReaderDiscoveryInfo::REMOVED_READER, reader.info.guid(),
              reader.info.m_qos.m_userData.getValue());
  }
  void on_publisher_discovery(dds::DomainParticipant* /*participant*/, rtps::WriterDiscoveryInfo&& writer) final {
    on_writer(writer.status != rtps::WriterDiscoveryInfo::REMOVED_WRITER, writer.info.guid(),
              writer.info.m_qos.m_partition.getNames());
  }
#endif
};

// --- types ---

/// The generated type support, with the same functions in either generation. No information about the type is sent:
/// other DDS implementations would refuse the type.
template <class Generated>
class GeneratedType : public Generated {
 public:
  using Sample = typename Generated::type;
#if ALOFT_FAST_DDS_3
  void register_type_object_representation() final {}
#else
  GeneratedType() {
    this->auto_fill_type_information(false);
    this->auto_fill_type_object(false);
  }
#endif

  [[nodiscard]] std::string type_name() const {
#if ALOFT_FAST_DDS_3
    return this->get_name();
#else
    return this->getName();
#endif
  }

  /// The length of the longest payload.
  [[nodiscard]] std::size_t max_bytes() const noexcept {
#if ALOFT_FAST_DDS_3
    return this->max_serialized_type_size;
#else
    return this->m_typeSize;
#endif
  }

  /// What the middleware calls with a payload that arrived. False: the sample is dropped.
  virtual bool from_bytes(rtps::SerializedPayload_t& payload, void* sample) {
#if ALOFT_FAST_DDS_3
    return Generated::deserialize(payload, sample);
#else
    return Generated::deserialize(&payload, sample);
#endif
  }

  /// What the middleware calls with a sample to be sent.
  virtual bool to_bytes(const void* sample, rtps::SerializedPayload_t& payload) {
#if ALOFT_FAST_DDS_3
    return Generated::serialize(sample, payload, dds::DataRepresentationId_t::XCDR_DATA_REPRESENTATION);
#else
    return Generated::serialize(const_cast<void*>(sample), &payload);  // which changes nothing
#endif
  }

  /// Room for to_bytes(), perhaps more than it uses.
  [[nodiscard]] virtual std::uint32_t room_for(const void* sample) {
#if ALOFT_FAST_DDS_3
    return Generated::calculate_serialized_size(sample, dds::DataRepresentationId_t::XCDR_DATA_REPRESENTATION);
#else
    return Generated::getSerializedSizeProvider(const_cast<void*>(sample))();
#endif
  }

  /// Whether `sample` takes `length` bytes, or up to 3 less (padding).
  [[nodiscard]] bool takes(const void* sample, std::size_t length) {
    constexpr std::size_t padding = 3;
#if ALOFT_FAST_DDS_3
    // What room_for() says is too much by a few bytes after some empty sequences.
    rtps::SerializedPayload_t again(static_cast<std::uint32_t>(length));
    if (!GeneratedType::to_bytes(sample, again)) return false;
    const std::size_t expected = again.length;
#else
    const std::size_t expected = Sample::getCdrSerializedSize(*static_cast<const Sample*>(sample)) +
                                 rtps::SerializedPayload_t::representation_header_size;
#endif
    return expected <= length && length <= expected + padding;
  }

 private:
#if ALOFT_FAST_DDS_3
  bool deserialize(rtps::SerializedPayload_t& payload, void* sample) final { return from_bytes(payload, sample); }
  bool serialize(const void* sample, rtps::SerializedPayload_t& payload,
                 dds::DataRepresentationId_t /*representation*/) final {
    return to_bytes(sample, payload);
  }
  std::uint32_t calculate_serialized_size(const void* sample, dds::DataRepresentationId_t /*representation*/) final {
    return room_for(sample);
  }
#else
  bool deserialize(rtps::SerializedPayload_t* payload, void* sample) final { return from_bytes(*payload, sample); }
  bool serialize(void* sample, rtps::SerializedPayload_t* payload) final { return to_bytes(sample, *payload); }
  std::function<std::uint32_t()> getSerializedSizeProvider(void* sample) final {  // NOLINT: the name is the base's
    return [this, sample] { return room_for(sample); };
  }
#endif
};

// --- transport ---

/// A transport that changes nothing about what is sent.
class SendingTransport : public rtps::ChainingTransport {
 public:
  using ChainingTransport::ChainingTransport;

#if ALOFT_FAST_DDS_3
  bool send(rtps::SenderResource* below, const std::vector<rtps::NetworkBuffer>& buffers, std::uint32_t size,
            rtps::LocatorsIterator* begin, rtps::LocatorsIterator* end,
            const std::chrono::steady_clock::time_point& timeout) final {
    return below->send(buffers, size, begin, end, timeout);
  }
#else
  bool send(rtps::SenderResource* below, const rtps::octet* bytes, std::uint32_t size, rtps::LocatorsIterator* begin,
            rtps::LocatorsIterator* end, const std::chrono::steady_clock::time_point& timeout) final {
    return below->send(bytes, size, begin, end, timeout);
  }
#endif
};

}  // namespace aloft::bus

#undef ALOFT_FAST_DDS_3
