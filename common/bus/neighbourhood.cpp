#include "common/bus/neighbourhood.hpp"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <fastdds/dds/domain/DomainParticipant.hpp>
#include <set>
#include <sstream>

#include "common/base/plain_text.hpp"

namespace aloft::bus {

namespace {

constexpr std::size_t max_known = 4096;  // participants

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
  std::mutex mutex_;
  std::map<std::string, Known> known_;
};

KnownParticipants& known_participants() {
  static KnownParticipants known;
  return known;
}

constexpr std::string_view middleware_mark = "aloft-on:";

/// What Neighbourhood::naming() says; empty if these are other data.
std::string middleware_named(const std::vector<rtps::octet>& user_data) {
  constexpr std::size_t longest = 32;
  const std::string text(user_data.begin(), user_data.end());
  return text.starts_with(middleware_mark) ? plain_text(text.substr(middleware_mark.size()), longest) : "";
}

/// "'aloft-channel-w0' at 10.0.0.7", and the holder of the certificate that it shows, if any. Nothing of it is
/// verified.
std::string introduction(const PeerData& peer) {
  std::string text = fmt::format("'{}'", name_of(peer));
  if (!peer.default_locators.unicast.empty())
    text += " at " + rtps::IPLocator::ip_to_string(peer.default_locators.unicast.front());
  const ShownCertificate certificate = certificate_of(peer);
  return certificate.subject.empty() ? text : fmt::format("{} ({})", text, certificate.subject);
}

}  // namespace

void Neighbourhood::farewell(const rtps::GuidPrefix_t& participant) {
  spdlog::debug("{} leaves", name_of(participant));
  rediscovery_.left(participant);
}

void Neighbourhood::on_peer(Change change, const PeerData& peer) {
  const rtps::GuidPrefix_t& prefix = prefix_of(peer);
  if (change == Change::left) farewell(prefix);
  if (change == Change::silent) {
    spdlog::debug("{} is silent", introduction(peer));
    rediscovery_.fell_silent(prefix, Rediscovery::Clock::now());
  }
  if (change != Change::found) return;
  spdlog::debug("discovered {}", introduction(peer));
  rediscovery_.heard(prefix, introduction(peer), Rediscovery::Clock::now());
  if (thread_ != nullptr) thread_->peer_is_back();
  known_participants().add(prefix, introduction(peer));
  if (!authority_.empty()) check(peer);
  const std::lock_guard lock(mutex_);
  if (middlewares_.size() >= max_known) middlewares_.clear();
  middlewares_[prefix] = middleware_named(user_data_of(peer));
}

/// The middleware reports a failed handshake to one side only, depending on which began it: so check here as well.
void Neighbourhood::check(const PeerData& peer) const {
  const ShownCertificate certificate = certificate_of(peer);
  if (!certificate.shown)
    known_participants().refuse(prefix_of(peer), "shows no certificate (started without --secure?)");
  else if (certificate.authority.find(authority_) == std::string::npos)
    known_participants().refuse(prefix_of(peer), "shows a certificate of another authority");
}

std::vector<rtps::octet> Neighbourhood::naming(const std::string& middleware) {
  const std::string text = std::string(middleware_mark) + middleware;
  return {text.begin(), text.end()};
}

void Neighbourhood::onParticipantAuthentication(dds::DomainParticipant* /*participant*/,
                                                rtps::ParticipantAuthenticationInfo&& info) {
  if (info.status == rtps::ParticipantAuthenticationInfo::UNAUTHORIZED_PARTICIPANT)
    known_participants().refuse(info.guid.guidPrefix,
                                "cannot prove who it is, or its certificate or permissions are not valid");
}

void Neighbourhood::on_reader(dds::DomainParticipant& self, bool known, const rtps::GUID_t& reader,
                              const std::vector<rtps::octet>& user_data) {
  if (!known) return rediscovery_.removed(reader, Rediscovery::Kind::reader);
  rediscovery_.found(reader, Rediscovery::Kind::reader);
  if (rediscovery_.asks(reader.guidPrefix, user_data, self.guid().guidPrefix) && thread_ != nullptr)
    thread_->peer_asks();
}

void Neighbourhood::on_writer(bool known, const rtps::GUID_t& writer, const std::vector<std::string>& partitions) {
  if (known)
    rediscovery_.found(writer, Rediscovery::Kind::writer);
  else
    rediscovery_.removed(writer, Rediscovery::Kind::writer);
  const std::lock_guard lock(mutex_);
  if (!known) {
    runs_.erase(writer);
    return;
  }
  for (const std::string& partition : partitions) {
    if (partition.rfind(partition_root, 0) != 0) continue;
    const std::string path = partition.substr(partition_root.size());
    runs_[writer] = path.substr(0, path.find('/'));
  }
}

std::vector<std::string> Neighbourhood::runs() const {
  const std::lock_guard lock(mutex_);
  std::set<std::string> names;
  for (const auto& [writer, run] : runs_) names.insert(run);
  return {names.begin(), names.end()};
}

std::vector<std::string> Neighbourhood::middleware_of(const std::string& run) const {
  const std::lock_guard lock(mutex_);
  std::set<std::string> names;
  for (const auto& [writer, its_run] : runs_)
    if (const auto at = middlewares_.find(writer.guidPrefix); its_run == run && at != middlewares_.end())
      names.insert(at->second);
  names.erase("");
  return {names.begin(), names.end()};
}

std::string Neighbourhood::name_of(const rtps::GuidPrefix_t& participant) {
  return name_of(text(participant));
}

std::string Neighbourhood::name_of(const std::string& participant) {
  return known_participants().name(participant);
}

}  // namespace aloft::bus
