#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "common/security/roles.hpp"

/// The files behind `--secure DIR`: certificates, keys and permissions (DDS Security), made with OpenSSL.
///
///     DIR/ca.cert.pem             the authority that every process trusts; public
///     DIR/ca.key.pem              issues certificates and permissions; keep it apart, processes do not need it
///     DIR/governance.p7s          what is encrypted and authenticated, the same for all processes; public
///     DIR/ROLE/cert.pem           one process's identity; its organisational unit is the role
///     DIR/ROLE/key.pem            its private key, mode 0600
///     DIR/ROLE/permissions.p7s    the topics that it may write and read
namespace aloft::security {

/// The files that a process of a secured run uses.
struct KeyFiles {
  std::filesystem::path ca;
  std::filesystem::path certificate;
  std::filesystem::path private_key;
  std::filesystem::path governance;
  std::filesystem::path permissions;
  std::string authority;  ///< the common name of the CA, which no other CA has
};

/// The files of `role` in `dir`, checked: they exist, only the owner can read the private key, they are signed by the
/// CA, valid today, and of this role. InputError names the first file that is wrong, and what to do.
[[nodiscard]] KeyFiles check_keys(const std::filesystem::path& dir, Role role);

/// Makes a certificate authority, valid for so many days, and the governance in `dir`, which must not hold one yet
/// (InputError).
void init_keys(const std::filesystem::path& dir, int days);

/// The holder of an identity, and the days on which it is valid.
struct Identity {
  Role role = Role::observer;
  std::string name{};  ///< e.g. a host; letters, digits, '.', '_' and '-'
  int days = 365;      ///< that it is valid
  int first_day = 0;   ///< counted from now
};

/// Names of the topics that an identity may use.
struct TopicRights {
  std::vector<std::string_view> writes;
  std::vector<std::string_view> reads;
};

/// Issues an identity with the authority of `dir` into `out` (`dir` itself, or the folder for another host),
/// replacing one that is there. InputError if the authority is missing or has expired.
void issue_keys(const std::filesystem::path& dir, const Identity& identity, const TopicRights& topics,
                const std::filesystem::path& out);

/// The permissions of an identity as DDS Security writes them; `subject` is that of its certificate.
[[nodiscard]] std::string permissions_xml(const Identity& identity, const TopicRights& topics,
                                          const std::string& subject);

/// The governance document of DDS Security: every process authenticates, and each endpoint, also those of discovery and
/// liveliness, encrypts all its messages with a key of its own, which only peers that may read or write there get.
/// (rtps_protection_kind, one key for all messages of a process, would not protect against a peer that has this key,
/// and makes the middleware size its buffers wrongly.)
[[nodiscard]] const std::string& governance_xml();

/// Signs `text` with the authority of `dir`, as governance and permissions must be.
[[nodiscard]] std::string sign_document(const std::filesystem::path& dir, const std::string& text);

}  // namespace aloft::security
