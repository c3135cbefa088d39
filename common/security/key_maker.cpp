#include <fmt/chrono.h>
#include <fmt/format.h>
#include <openssl/ec.h>
#include <openssl/pem.h>
#include <openssl/rand.h>
#include <openssl/x509v3.h>

#include <array>
#include <ctime>
#include <stdexcept>
#include <system_error>

#include "common/base/error.hpp"
#include "common/base/read_file.hpp"
#include "common/base/write_file.hpp"
#include "common/security/keys.hpp"
#include "common/security/openssl.hpp"

namespace aloft::security {
namespace {

namespace fs = std::filesystem;

constexpr std::time_t day_s = 24 * 60 * 60;
constexpr std::time_t clock_skew_s = 10 * 60;  // clocks of other hosts may be behind
constexpr mode_t public_mode = 0644;
constexpr mode_t private_mode = 0600;

/// For failures of OpenSSL that no input can cause.
void check(bool good, const char* what) {
  if (!good) throw std::runtime_error(fmt::format("OpenSSL failed: {}", what));
}

void make_folder(const fs::path& dir) {
  std::error_code error;
  fs::create_directories(dir, error);
  if (error) throw InputError("cannot make the folder {}: {}", dir.string(), error.message());
}

std::string pem(X509* certificate) {
  const openssl::Bio bio(BIO_new(BIO_s_mem()));
  check(PEM_write_bio_X509(bio.get(), certificate) == 1, "writing a certificate");
  return openssl::text_of(bio.get());
}

std::string pem(EVP_PKEY* key) {
  const openssl::Bio bio(BIO_new(BIO_s_mem()));
  check(PEM_write_bio_PKCS8PrivateKey(bio.get(), key, nullptr, nullptr, 0, nullptr, nullptr) == 1, "writing a key");
  return openssl::text_of(bio.get());
}

void add_extension(X509* certificate, X509* issuer, int nid, const char* value) {
  X509V3_CTX context;
  X509V3_set_ctx(&context, issuer, certificate, nullptr, nullptr, 0);
  const openssl::Extension extension(X509V3_EXT_conf_nid(nullptr, &context, nid, value));
  check(extension && X509_add_ext(certificate, extension.get(), -1) == 1, "adding an extension");
}

void add_name(X509_NAME* name, const char* field, std::string_view text) {
  check(X509_NAME_add_entry_by_txt(name, field, MBSTRING_UTF8, reinterpret_cast<const unsigned char*>(text.data()),
                                   static_cast<int>(text.size()), -1, 0) == 1,
        "naming a certificate");
}

/// A certificate without its issuer's signature.
openssl::Certificate draft_certificate(EVP_PKEY* key, std::string_view unit, const Identity& identity) {
  openssl::Certificate certificate(X509_new());
  X509_set_version(certificate.get(), X509_VERSION_3);
  const openssl::Number serial(BN_new());
  check(BN_rand(serial.get(), 127, BN_RAND_TOP_ANY, BN_RAND_BOTTOM_ANY) == 1, "choosing a serial number");
  BN_to_ASN1_INTEGER(serial.get(), X509_get_serialNumber(certificate.get()));
  X509_gmtime_adj(X509_getm_notBefore(certificate.get()), identity.first_day * day_s - clock_skew_s);
  X509_gmtime_adj(X509_getm_notAfter(certificate.get()), (identity.first_day + identity.days) * day_s);
  X509_NAME* subject = X509_get_subject_name(certificate.get());
  add_name(subject, "O", "Aloft");
  add_name(subject, "OU", unit);
  add_name(subject, "CN", identity.name);
  check(X509_set_pubkey(certificate.get(), key) == 1, "setting a public key");
  return certificate;
}

/// The common name of a new authority, by which processes tell it from all others.
std::string unique_name() {
  std::array<unsigned char, 8> bytes{};
  check(RAND_bytes(bytes.data(), static_cast<int>(bytes.size())) == 1, "choosing a name");
  return fmt::format("Aloft authority {:02x}", fmt::join(bytes, ""));
}

struct Authority {
  openssl::Certificate certificate;
  openssl::Key key;
};

Authority open_authority(const fs::path& dir) {
  const std::string advice =
      fmt::format("there is no authority in {}; make one: aloft keys init {}", dir.string(), dir.string());
  const auto content = [&](const char* name) {
    try {
      return read_file(dir / name);
    } catch (const InputError& error) {
      throw InputError("{}; {}", error.what(), advice);
    }
  };
  const std::string certificate = content("ca.cert.pem");
  const std::string key = content("ca.key.pem");
  Authority authority{
      openssl::Certificate(PEM_read_bio_X509(openssl::memory(certificate).get(), nullptr, nullptr, nullptr)),
      openssl::Key(PEM_read_bio_PrivateKey(openssl::memory(key).get(), nullptr, nullptr, nullptr))};
  if (!authority.certificate || !authority.key ||
      X509_check_private_key(authority.certificate.get(), authority.key.get()) != 1)
    throw InputError("{}: ca.cert.pem and ca.key.pem are not a certificate and its key; {}", dir.string(), advice);
  if (X509_cmp_current_time(X509_get0_notAfter(authority.certificate.get())) < 0)
    throw InputError("{}: the authority has expired; make a new one in another folder: aloft keys init NEW",
                     (dir / "ca.cert.pem").string());
  return authority;
}

std::string topic_rules(const char* direction, const std::vector<std::string_view>& names) {
  if (names.empty()) return "";
  std::string topics;
  for (const std::string_view name : names) topics += fmt::format("            <topic>{}</topic>\n", name);
  return fmt::format(
      "        <{0}>\n          <topics>\n{1}          </topics>\n"
      "          <partitions><partition>aloft/*</partition></partitions>\n        </{0}>\n",
      direction, topics);
}

/// The folder of an authority holds nothing else, so that it can be copied or deleted as a whole.
void check_is_free(const fs::path& dir) {
  std::error_code unreadable;  // creating it will fail, too, with an error that says why
  if (fs::exists(dir / "ca.key.pem") || fs::exists(dir / "ca.cert.pem"))
    throw InputError("{} holds an authority already; use another folder, or remove it if nothing trusts it any more",
                     dir.string());
  for (const auto& entry : fs::directory_iterator(dir, unreadable))
    throw InputError("{} holds other things ('{}'); use a new or empty folder for an authority", dir.string(),
                     entry.path().filename().string());
}

void write_governance(const fs::path& dir) {
  write_file(dir / "governance.p7s", sign_document(dir, governance_xml()), public_mode);
}

}  // namespace

std::string permissions_xml(const Identity& identity, const TopicRights& topics, const std::string& subject) {
  const std::time_t first = std::time(nullptr) + identity.first_day * day_s;
  // The certificate's dates count; these are wider, as some implementations read them as local time.
  return fmt::format(
      R"(<?xml version="1.0" encoding="UTF-8"?>
<dds xmlns:xsi="http://www.w3.org/2001/XMLSchema-instance" xsi:noNamespaceSchemaLocation="http://www.omg.org/spec/DDS-SECURITY/20170901/omg_shared_ca_permissions.xsd">
  <permissions>
    <grant name="{}">
      <subject_name>{}</subject_name>
      <validity>
        <not_before>{:%Y-%m-%dT%H:%M:%S}</not_before>
        <not_after>{:%Y-%m-%dT%H:%M:%S}</not_after>
      </validity>
      <allow_rule>
        <domains>
          <id_range><min>0</min><max>101</max></id_range>
        </domains>
{}{}      </allow_rule>
      <default>DENY</default>
    </grant>
  </permissions>
</dds>
)",
      to_text(identity.role), subject, fmt::gmtime(first - 2 * day_s), fmt::gmtime(first + (identity.days + 1) * day_s),
      topic_rules("publish", topics.writes), topic_rules("subscribe", topics.reads));
}

const std::string& governance_xml() {
  static const std::string text = R"(<?xml version="1.0" encoding="UTF-8"?>
<dds xmlns:xsi="http://www.w3.org/2001/XMLSchema-instance" xsi:noNamespaceSchemaLocation="http://www.omg.org/spec/DDS-SECURITY/20170901/omg_shared_ca_governance.xsd">
  <domain_access_rules>
    <domain_rule>
      <domains>
        <id_range><min>0</min><max>101</max></id_range>
      </domains>
      <allow_unauthenticated_participants>false</allow_unauthenticated_participants>
      <enable_join_access_control>true</enable_join_access_control>
      <discovery_protection_kind>ENCRYPT</discovery_protection_kind>
      <liveliness_protection_kind>ENCRYPT</liveliness_protection_kind>
      <rtps_protection_kind>NONE</rtps_protection_kind>
      <topic_access_rules>
        <topic_rule>
          <topic_expression>*</topic_expression>
          <enable_discovery_protection>true</enable_discovery_protection>
          <enable_liveliness_protection>true</enable_liveliness_protection>
          <enable_read_access_control>true</enable_read_access_control>
          <enable_write_access_control>true</enable_write_access_control>
          <metadata_protection_kind>ENCRYPT</metadata_protection_kind>
          <data_protection_kind>NONE</data_protection_kind>
        </topic_rule>
      </topic_access_rules>
    </domain_rule>
  </domain_access_rules>
</dds>
)";
  return text;
}

std::string sign_document(const fs::path& dir, const std::string& text) {
  const Authority authority = open_authority(dir);
  const openssl::Bio source = openssl::memory(text);
  constexpr int flags = PKCS7_TEXT | PKCS7_DETACHED;
  const openssl::Pkcs7 document(
      PKCS7_sign(authority.certificate.get(), authority.key.get(), nullptr, source.get(), flags));
  check(document != nullptr, "signing a document");
  const openssl::Bio again = openssl::memory(text);
  const openssl::Bio out(BIO_new(BIO_s_mem()));
  check(SMIME_write_PKCS7(out.get(), document.get(), again.get(), flags) == 1, "writing a signed document");
  return openssl::text_of(out.get());
}

void init_keys(const fs::path& dir, int days) {
  check_is_free(dir);
  make_folder(dir);
  const openssl::Key key(EVP_EC_gen("P-256"));
  check(key != nullptr, "making a key");
  const openssl::Certificate certificate =
      draft_certificate(key.get(), "authority", {.name = unique_name(), .days = days});
  X509* const self = certificate.get();
  X509_set_issuer_name(self, X509_get_subject_name(self));
  add_extension(self, self, NID_basic_constraints, "critical,CA:TRUE,pathlen:0");
  add_extension(self, self, NID_key_usage, "critical,keyCertSign,digitalSignature");
  add_extension(self, self, NID_subject_key_identifier, "hash");
  check(X509_sign(self, key.get(), EVP_sha256()) > 0, "signing a certificate");
  write_file(dir / "ca.key.pem", pem(key.get()), private_mode);
  write_file(dir / "ca.cert.pem", pem(self), public_mode);
  write_governance(dir);
}

void issue_keys(const fs::path& dir, const Identity& identity, const TopicRights& topics, const fs::path& out) {
  const Authority authority = open_authority(dir);
  const openssl::Key key(EVP_EC_gen("P-256"));
  check(key != nullptr, "making a key");
  const openssl::Certificate certificate = draft_certificate(key.get(), to_text(identity.role), identity);
  X509* const own = certificate.get();
  X509_set_issuer_name(own, X509_get_subject_name(authority.certificate.get()));
  add_extension(own, authority.certificate.get(), NID_basic_constraints, "critical,CA:FALSE");
  add_extension(own, authority.certificate.get(), NID_key_usage, "critical,digitalSignature,keyAgreement");
  check(X509_sign(own, authority.key.get(), EVP_sha256()) > 0, "signing a certificate");

  write_governance(dir);  // the authority may be older than this program
  const fs::path folder = out / to_text(identity.role);
  make_folder(folder);
  write_file(folder / "key.pem", pem(key.get()), private_mode);
  write_file(folder / "cert.pem", pem(own), public_mode);
  write_file(folder / "permissions.p7s",
             sign_document(dir, permissions_xml(identity, topics, openssl::subject_text(own))), public_mode);
  if (out == dir) return;
  for (const char* common : {"ca.cert.pem", "governance.p7s"})
    write_file(out / common, read_file(dir / common), public_mode);
}

}  // namespace aloft::security
