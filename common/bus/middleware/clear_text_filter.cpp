#include "common/bus/middleware/clear_text_filter.hpp"

#include <spdlog/spdlog.h>

#include <atomic>
#include <bit>
#include <utility>

#include "common/bus/middleware/rtps_message.hpp"

namespace aloft::bus {
namespace {

/// The id of the endpoint at `offset`; 0 if the submessage is cut.
unsigned endpoint_at(std::size_t offset, const unsigned char* content, std::size_t size) noexcept {
  if (size < offset + 4) return 0;
  unsigned id = 0;
  for (std::size_t i = offset; i < offset + 4; ++i) id = id << 8U | content[i];
  return id;
}

bool permitted(unsigned kind, const unsigned char* content, std::size_t size) noexcept {
  using namespace rtps_message;
  switch (kind) {
    case pad:
    case info_ts:
    case info_dst:
    case sec_prefix:
    case sec_body:
    case sec_postfix:
      return true;
    case data:
    case data_frag: {
      const unsigned writer = endpoint_at(8, content, size);
      return writer == announcements || writer == handshakes;
    }
    case acknack:
    case heartbeat: {
      const unsigned writer = endpoint_at(4, content, size);
      // A secured run uses the encrypted twins of these; the clear ones stay empty, and exchange only heartbeats and
      // acknowledgements that say so.
      return writer == clear_publications || writer == clear_subscriptions || writer == clear_liveliness;
    }
    default:
      return kind >= first_of_vendors;
  }
}

}  // namespace

Transport without_clear_text(Transport below) {
  const auto dropped = std::make_shared<std::atomic<std::uint64_t>>(0);
  return receiving_through(
      [dropped](const unsigned char* bytes, std::uint32_t size, const rtps::Locator_t& remote, const auto& deliver) {
        if (permitted_in_secured_run(bytes, size)) return deliver();
        const std::uint64_t so_far = ++*dropped;
        if (std::has_single_bit(so_far))
          spdlog::warn("dropped a message in clear text from {}; {} so far", rtps::IPLocator::ip_to_string(remote),
                       so_far);
      },
      std::move(below));
}

bool permitted_in_secured_run(const unsigned char* bytes, std::size_t size) noexcept {
  return rtps_message::all_submessages(bytes, size, permitted);
}

}  // namespace aloft::bus
