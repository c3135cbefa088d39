#pragma once

// Inside common/bus only: the middleware's side of Participant.

#include <spdlog/spdlog.h>

#include <array>
#include <atomic>
#include <bit>
#include <chrono>
#include <exception>
#include <fastdds/dds/domain/DomainParticipant.hpp>
#include <fastdds/dds/publisher/Publisher.hpp>
#include <fastdds/dds/subscriber/DataReader.hpp>
#include <fastdds/dds/subscriber/Subscriber.hpp>
#include <fastdds/dds/topic/Topic.hpp>
#include <fastdds/dds/topic/TopicDataType.hpp>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "common/bus/guard/datagram_guard.hpp"
#include "common/bus/middleware/generation.hpp"
#include "common/bus/neighbourhood.hpp"
#include "common/bus/participant.hpp"
#include "common/bus/topics.hpp"

namespace aloft::bus {

/// Clients address the discovery server also by its GUID prefix, which can be the same in all runs: a server serves one
/// run.
inline constexpr const char* server_prefix = "44.53.00.5f.61.6c.6f.66.74.00.00.01";

/// Counts refused samples of one topic; from any thread. Logs the first, second, fourth, ... of each kind.
class DropCounter {
 public:
  explicit DropCounter(std::string_view topic) : topic_(topic) {}

  void malformed(const char* why) { count(malformed_, "a malformed", why); }
  void invalid(const char* why) { count(invalid_, "an invalid", why); }
  void foreign(const char* why) { count(foreign_, "a foreign", why); }
  [[nodiscard]] Drops drops() const { return {malformed_, invalid_, foreign_}; }

 private:
  void count(std::atomic<std::uint64_t>& counter, const char* kind, const char* why) {
    const std::uint64_t seen = ++counter;
    if (std::has_single_bit(seen)) spdlog::warn("{}: dropped {} sample ({}); {} so far", topic_, kind, why, seen);
  }

  std::string_view topic_;
  std::atomic<std::uint64_t> malformed_{0};
  std::atomic<std::uint64_t> invalid_{0};
  std::atomic<std::uint64_t> foreign_{0};
};

/// The generated type support, made safe: the middleware calls from_bytes() from its receiving threads and does not
/// survive an exception there. Samples are padded to four bytes: the middleware writes a number of four bytes into each
/// fragment that it waits for, and the guard refuses samples whose last one has no room for it. Samples whose size does
/// not fit their content (a text that would be cut, trailing bytes) are malformed, as are all that are not plain XCDR1:
/// the lengths in an XCDR2 sample are not bounded by its bytes.
template <class Generated>
class CheckedType : public GeneratedType<Generated> {
 public:
  explicit CheckedType(DropCounter& drops) : drops_(drops) {}

  std::uint32_t room_for(const void* sample) override {
    return (GeneratedType<Generated>::room_for(sample) + 3U) & ~3U;
  }

  bool to_bytes(const void* sample, rtps::SerializedPayload_t& payload) override {
    if (!GeneratedType<Generated>::to_bytes(sample, payload)) return false;
    while (payload.length % 4 != 0 && payload.length < payload.max_size) payload.data[payload.length++] = 0;
    return true;
  }

  bool from_bytes(rtps::SerializedPayload_t& payload, void* sample) override {
    if (payload.length < rtps::SerializedPayload_t::representation_header_size || payload.data[0] != 0 ||
        payload.data[1] > 1) {
      drops_.malformed("not XCDR1");
      return false;
    }
    // Fast CDR gives a sequence no more elements than there are bytes left: so a payload that is no larger than the
    // type cannot ask for much memory. (Sequences of strings can: see AgentName in idl/world.idl.)
    if (payload.length > this->max_bytes()) {
      drops_.malformed("longer than its type");
      return false;
    }
    try {
      if (!GeneratedType<Generated>::from_bytes(payload, sample)) {
        drops_.malformed("not this type");
        return false;
      }
      if (!this->takes(sample, payload.length)) {
        drops_.malformed("longer or shorter than its content");
        return false;
      }
      return true;
    } catch (const std::exception& error) {
      drops_.malformed(error.what());
    } catch (...) {
      drops_.malformed("unknown exception");
    }
    return false;
  }

 private:
  DropCounter& drops_;
};

/// Owns the middleware's participant and, made when first needed, one publisher and subscriber per scope and one topic
/// per type. A thread of its own restores the connections of processes that lost each other
/// (middleware/rediscovery.hpp).
struct Participant::State {
  explicit State(const BusOptions& options);
  ~State();
  State(const State&) = delete;
  State& operator=(const State&) = delete;

  dds::Publisher& publisher(Scope scope);
  dds::Subscriber& subscriber(Scope scope);
  [[nodiscard]] std::string partition(Scope scope) const;

  struct TopicEntry {
    std::unique_ptr<DropCounter> drops;
    dds::Topic* topic = nullptr;
  };
  template <class Generated>
  TopicEntry& topic(const TopicSettings& settings) {
    const std::lock_guard lock(mutex);
    TopicEntry& entry = topics[settings.name];
    if (entry.topic != nullptr) return entry;
    if (!entry.drops) entry.drops = std::make_unique<DropCounter>(settings.name);
    register_topic(entry, settings, dds::TypeSupport(new CheckedType<Generated>(*entry.drops)));
    return entry;
  }
  void register_topic(TopicEntry& entry, const TopicSettings& settings, const dds::TypeSupport& type);

  void add(dds::DataReader& reader);
  void remove(dds::DataReader& reader);

  BusOptions options;
  std::shared_ptr<guard::DatagramGuard> guard;
  mutable std::mutex mutex;  // also held while the quality of service of an endpoint changes
  Neighbourhood neighbourhood;
  RediscoveryThread rediscovery{neighbourhood.rediscovery(), [this](const auto& question) { ask(question); },
                                [this] { announce(); }};
  dds::DomainParticipant* participant = nullptr;
  std::array<dds::Publisher*, 4> publishers{};
  std::array<dds::Subscriber*, 4> subscribers{};
  std::map<std::string_view, TopicEntry> topics;
  std::vector<dds::DataReader*> readers;

 private:
  void ask(const Rediscovery::Question& question);
  void announce();
};

}  // namespace aloft::bus
