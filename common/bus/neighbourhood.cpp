#include "common/bus/neighbourhood.hpp"

#include <fastrtps/utils/IPLocator.h>
#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <fastdds/dds/domain/DomainParticipant.hpp>
#include <set>
#include <sstream>

namespace aloft::bus {

namespace dds = eprosima::fastdds::dds;
namespace rtps = eprosima::fastrtps::rtps;

namespace {

/// The id of a participant, as the middleware writes it in its log.
std::string text(const rtps::GuidPrefix_t& participant) {
  std::ostringstream stream;
  stream << participant;
  return stream.str();
}

/// All participants that this process has discovered, by the ids that the middleware writes in its log.
class KnownParticipants {
 public:
  void add(const rtps::GuidPrefix_t& participant, std::string name) {
    const std::lock_guard lock(mutex_);
    if (known_.size() >= max_known) known_.clear();
    known_.try_emplace(text(participant), Known{std::move(name), {}});
  }
  std::string name(const std::string& participant) {
    const std::lock_guard lock(mutex_);
    const auto at = known_.find(participant);
    return at == known_.end() ? "a process that is gone" : at->second.name;
  }
  /// Logs that a participant is refused, once for each.
  void refuse(const rtps::GuidPrefix_t& participant, const std::string& why) {
    const std::lock_guard lock(mutex_);
    const auto at = known_.find(text(participant));
    if (at == known_.end() || at->second.refused) return;
    at->second.refused = true;
    spdlog::warn("refused a participant: {} {}", at->second.name, why);
  }

 private:
  struct Known {
    std::string name;
    bool refused = false;
  };
  static constexpr std::size_t max_known = 4096;

  std::mutex mutex_;
  std::map<std::string, Known> known_;
};

KnownParticipants& known_participants() {
  static KnownParticipants known;
  return known;
}

std::string property(const rtps::IdentityToken& token, const char* name) {
  const std::string* value = rtps::DataHolderHelper::find_property_value(token, name);
  return value == nullptr ? "" : *value;
}

/// "'aloft-channel-w0' at 10.0.0.7", and the holder of the certificate that it shows, if any. Nothing of it is
/// verified.
std::string introduction(const rtps::ParticipantProxyData& data) {
  std::string text = fmt::format("'{}'", data.m_participantName.c_str());
  if (!data.default_locators.unicast.empty())
    text += " at " + rtps::IPLocator::ip_to_string(data.default_locators.unicast.front());
  const std::string subject = property(data.identity_token_, "dds.cert.sn");
  return subject.empty() ? text : fmt::format("{} ({})", text, subject);
}

}  // namespace

void Neighbourhood::on_participant_discovery(dds::DomainParticipant* /*participant*/,
                                             rtps::ParticipantDiscoveryInfo&& info) {
  using Info = rtps::ParticipantDiscoveryInfo;
  const rtps::ParticipantProxyData& data = info.info;
  if (info.status == Info::REMOVED_PARTICIPANT) {
    spdlog::debug("{} leaves", introduction(data));
    rediscovery_.left(data.m_guid.guidPrefix);
  }
  if (info.status == Info::DROPPED_PARTICIPANT) {
    spdlog::debug("{} is silent", introduction(data));
    rediscovery_.fell_silent(data.m_guid.guidPrefix, Rediscovery::Clock::now());
  }
  if (info.status != Info::DISCOVERED_PARTICIPANT) return;
  spdlog::debug("discovered {}", introduction(data));
  rediscovery_.heard(data.m_guid.guidPrefix, introduction(data), Rediscovery::Clock::now());
  if (thread_ != nullptr) thread_->peer_is_back();
  known_participants().add(data.m_guid.guidPrefix, introduction(data));
  if (authority_.empty()) return;
  // The middleware reports a failed handshake to one side only, depending on which began it: so check here as well.
  if (data.identity_token_.class_id().empty())
    known_participants().refuse(data.m_guid.guidPrefix, "shows no certificate (started without --secure?)");
  else if (property(data.identity_token_, "dds.ca.sn").find(authority_) == std::string::npos)
    known_participants().refuse(data.m_guid.guidPrefix, "shows a certificate of another authority");
}

void Neighbourhood::onParticipantAuthentication(dds::DomainParticipant* /*participant*/,
                                                rtps::ParticipantAuthenticationInfo&& info) {
  if (info.status == rtps::ParticipantAuthenticationInfo::UNAUTHORIZED_PARTICIPANT)
    known_participants().refuse(info.guid.guidPrefix,
                                "cannot prove who it is, or its certificate or permissions are not valid");
}

void Neighbourhood::on_subscriber_discovery(dds::DomainParticipant* participant, rtps::ReaderDiscoveryInfo&& info) {
  const rtps::GUID_t& reader = info.info.guid();
  if (info.status == rtps::ReaderDiscoveryInfo::REMOVED_READER)
    return rediscovery_.removed(reader, Rediscovery::Kind::reader);
  rediscovery_.found(reader, Rediscovery::Kind::reader);
  const rtps::GuidPrefix_t& self = participant->guid().guidPrefix;
  if (rediscovery_.asks(reader.guidPrefix, info.info.m_qos.m_userData.getValue(), self) && thread_ != nullptr)
    thread_->peer_asks();
}

void Neighbourhood::on_publisher_discovery(dds::DomainParticipant* /*participant*/, rtps::WriterDiscoveryInfo&& info) {
  const bool removed = info.status == rtps::WriterDiscoveryInfo::REMOVED_WRITER;
  if (removed)
    rediscovery_.removed(info.info.guid(), Rediscovery::Kind::writer);
  else
    rediscovery_.found(info.info.guid(), Rediscovery::Kind::writer);
  const std::lock_guard lock(mutex_);
  if (removed) {
    runs_.erase(info.info.guid());
    return;
  }
  for (const std::string& partition : info.info.m_qos.m_partition.getNames()) {
    if (partition.rfind(partition_root, 0) != 0) continue;
    const std::string path = partition.substr(partition_root.size());
    runs_[info.info.guid()] = path.substr(0, path.find('/'));
  }
}

std::vector<std::string> Neighbourhood::runs() const {
  const std::lock_guard lock(mutex_);
  std::set<std::string> names;
  for (const auto& [writer, run] : runs_) names.insert(run);
  return {names.begin(), names.end()};
}

std::string Neighbourhood::name_of(const rtps::GuidPrefix_t& participant) {
  return name_of(text(participant));
}

std::string Neighbourhood::name_of(const std::string& participant) {
  return known_participants().name(participant);
}

}  // namespace aloft::bus
