#pragma once

// Inside common/bus only: the other participants of the domain.

#include <map>
#include <mutex>
#include <string>
#include <string_view>
#include <vector>

#include "common/bus/middleware/generation.hpp"
#include "common/bus/middleware/rediscovery.hpp"

namespace aloft::bus {

/// Keeps track of the other participants; the middleware calls it from its own threads. In a secured run it logs each
/// participant that the middleware refuses, once.
class Neighbourhood : public PeerListener {
 public:
  /// The authority whose certificates are accepted (KeyFiles::authority). Without this call the run is not secured.
  void expect_authority(std::string name) { authority_ = std::move(name); }
  /// Sets the thread to notify when a peer is back or asks for our endpoints; to be called before discovery begins.
  void tell(RediscoveryThread& thread) { thread_ = &thread; }
  [[nodiscard]] Rediscovery& rediscovery() noexcept { return rediscovery_; }
  /// Names of the runs of which a writer is known, sorted.
  [[nodiscard]] std::vector<std::string> runs() const;
  /// Participant::middleware_of
  [[nodiscard]] std::vector<std::string> middleware_of(const std::string& run) const;
  /// The user data by which a process names its middleware to others.
  [[nodiscard]] static std::vector<rtps::octet> naming(const std::string& middleware);
  /// "'aloft-channel-w0' at 10.0.0.7", unverified.
  [[nodiscard]] static std::string name_of(const rtps::GuidPrefix_t& participant);
  /// The same by the id that the middleware writes in its log.
  [[nodiscard]] static std::string name_of(const std::string& participant);

  /// A participant says that it leaves. Called by the guard, because the middleware does not hear of it
  /// (guard/datagram_guard.hpp); with a discovery server on behalf of the middleware.
  void farewell(const rtps::GuidPrefix_t& participant);
  void on_peer(Change change, const PeerData& peer) override;
  void on_reader(dds::DomainParticipant& self, bool known, const rtps::GUID_t& reader,
                 const std::vector<rtps::octet>& user_data) override;
  void on_writer(bool known, const rtps::GUID_t& writer, const std::vector<std::string>& partitions) override;
  void onParticipantAuthentication(dds::DomainParticipant* participant,
                                   rtps::ParticipantAuthenticationInfo&& info) override;

 private:
  void check(const PeerData& peer) const;

  std::string authority_;
  RediscoveryThread* thread_ = nullptr;
  Rediscovery rediscovery_;
  mutable std::mutex mutex_;
  std::map<rtps::GUID_t, std::string> runs_;               // by writer
  std::map<rtps::GuidPrefix_t, std::string> middlewares_;  // by participant
};

/// The partition of every run begins with this.
inline constexpr std::string_view partition_root = "aloft/";

}  // namespace aloft::bus
