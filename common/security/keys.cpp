#include "common/security/keys.hpp"

#include <fmt/chrono.h>
#include <fmt/format.h>
#include <openssl/err.h>
#include <openssl/pem.h>
#include <openssl/x509v3.h>
#include <sys/stat.h>

#include <ctime>

#include "common/base/error.hpp"
#include "common/base/read_file.hpp"
#include "common/security/openssl.hpp"

namespace aloft::security {
namespace {

namespace fs = std::filesystem;

/// What to do about a wrong file of a role.
std::string remedy(const fs::path& dir, Role role) {
  return fmt::format("issue it again: aloft keys issue {} {}", dir.string(), to_text(role));
}

std::string key_text(const fs::path& file, const std::string& advice) {
  constexpr std::uint64_t largest_bytes = 1U << 20U;
  if (!fs::exists(file)) throw InputError("{}: is missing; {}", file.string(), advice);
  try {
    return aloft::read_file(file, largest_bytes);
  } catch (const InputError& error) {
    throw InputError("{}; {}", error.what(), advice);
  }
}

openssl::Certificate read_certificate(const fs::path& file, const std::string& advice) {
  const std::string text = key_text(file, advice);
  openssl::Certificate certificate(PEM_read_bio_X509(openssl::memory(text).get(), nullptr, nullptr, nullptr));
  if (!certificate) throw InputError("{}: is not a certificate (PEM); {}", file.string(), advice);
  return certificate;
}

/// "2026-11-21T19:00:00", UTC.
std::string utc_text(std::time_t time) {
  return fmt::format("{:%Y-%m-%dT%H:%M:%S}", fmt::gmtime(time));
}

std::string utc_text(const ASN1_TIME* time) {
  std::tm parts{};
  ASN1_TIME_to_tm(time, &parts);
  return utc_text(timegm(&parts));
}

void check_dates(const X509* certificate, const fs::path& file, const std::string& advice) {
  const ASN1_TIME* first = X509_get0_notBefore(certificate);
  const ASN1_TIME* last = X509_get0_notAfter(certificate);
  if (X509_cmp_current_time(first) > 0)
    throw InputError("{}: is not valid before {} UTC; is this machine's clock right? Else {}", file.string(),
                     utc_text(first), advice);
  if (X509_cmp_current_time(last) < 0)
    throw InputError("{}: expired at {} UTC; {}", file.string(), utc_text(last), advice);
}

std::string entry(const X509* certificate, int nid) {
  const X509_NAME* subject = X509_get_subject_name(certificate);
  const int at = X509_NAME_get_index_by_NID(subject, nid, -1);
  if (at < 0) return "";
  const ASN1_STRING* text = X509_NAME_ENTRY_get_data(X509_NAME_get_entry(subject, at));
  return {reinterpret_cast<const char*>(ASN1_STRING_get0_data(text)),
          static_cast<std::size_t>(ASN1_STRING_length(text))};
}

void check_private(const fs::path& file, const X509* certificate, const std::string& advice) {
  struct stat facts {};
  if (stat(file.c_str(), &facts) != 0) throw InputError("{}: is missing; {}", file.string(), advice);
  if ((facts.st_mode & 0077U) != 0)
    throw InputError(
        "{}: other users can read this private key (mode {:03o}); chmod 600 it, and if another user has read it, {}",
        file.string(), facts.st_mode & 0777U, advice);
  const std::string text = key_text(file, advice);
  const openssl::Key key(PEM_read_bio_PrivateKey(openssl::memory(text).get(), nullptr, nullptr, nullptr));
  if (!key) throw InputError("{}: is not a private key (PEM); {}", file.string(), advice);
  if (X509_check_private_key(certificate, key.get()) != 1)
    throw InputError("{}: does not belong to cert.pem beside it; {}", file.string(), advice);
}

void check_certificate(X509* certificate, X509* authority, const fs::path& file, Role role, const std::string& advice) {
  const openssl::Key authority_key(X509_get_pubkey(authority));
  if (X509_verify(certificate, authority_key.get()) != 1)
    throw InputError("{}: was not issued by the authority in ca.cert.pem; {}", file.string(), advice);
  check_dates(certificate, file, advice);
  const std::string unit = entry(certificate, NID_organizationalUnitName);
  if (unit != to_text(role))
    throw InputError("{}: is for the role '{}', but this process is '{}'; {}", file.string(), unit, to_text(role),
                     advice);
}

/// The text of a document that the authority has signed.
std::string check_document(const fs::path& file, X509* authority, const std::string& advice) {
  const std::string text = key_text(file, advice);
  const openssl::Bio source = openssl::memory(text);
  BIO* content = nullptr;
  const openssl::Pkcs7 document(SMIME_read_PKCS7(source.get(), &content));
  const openssl::Bio owned(content);
  const openssl::Bio plain(BIO_new(BIO_s_mem()));
  STACK_OF(X509)* trusted = sk_X509_new_null();
  sk_X509_push(trusted, authority);
  const bool good = document && PKCS7_verify(document.get(), trusted, nullptr, content, plain.get(),
                                             PKCS7_TEXT | PKCS7_NOVERIFY | PKCS7_NOINTERN) == 1;
  sk_X509_free(trusted);
  if (!good)
    throw InputError("{}: was not signed by the authority in ca.cert.pem, or was altered; {}", file.string(), advice);
  return openssl::text_of(plain.get());
}

/// Text mode of S/MIME ends lines with CR LF.
std::string without_cr(std::string text) {
  std::erase(text, '\r');
  return text;
}

std::string between(const std::string& text, std::string_view first, std::string_view last) {
  const std::size_t begin = text.find(first);
  const std::size_t end = text.find(last);
  if (begin == std::string::npos || end == std::string::npos || end < begin) return "";
  return text.substr(begin + first.size(), end - begin - first.size());
}

void check_permissions(const fs::path& file, X509* authority, const X509* certificate, const std::string& advice) {
  const std::string text = check_document(file, authority, advice);
  if (between(text, "<subject_name>", "</subject_name>") != openssl::subject_text(certificate))
    throw InputError("{}: is for another certificate than cert.pem beside it; {}", file.string(), advice);
  const std::string last = between(text, "<not_after>", "</not_after>");
  if (last < utc_text(std::time(nullptr))) throw InputError("{}: expired at {} UTC; {}", file.string(), last, advice);
}

}  // namespace

KeyFiles check_keys(const fs::path& dir, Role role) {
  const std::string renew = fmt::format("make a new authority: aloft keys init {}", dir.string());
  const std::string reissue = remedy(dir, role);
  if (!fs::is_directory(dir)) throw InputError("--secure {}: there is no such folder; {}", dir.string(), renew);
  const fs::path own = dir / to_text(role);
  KeyFiles files{dir / "ca.cert.pem",    own / "cert.pem",        own / "key.pem",
                 dir / "governance.p7s", own / "permissions.p7s", ""};
  const openssl::Certificate authority = read_certificate(files.ca, renew);
  check_dates(authority.get(), files.ca, renew);
  files.authority = entry(authority.get(), NID_commonName);
  if (without_cr(check_document(files.governance, authority.get(), reissue)) != governance_xml())
    throw InputError("{}: was made by another version of Aloft, or for something else; {}", files.governance.string(),
                     reissue);
  const openssl::Certificate certificate = read_certificate(files.certificate, reissue);
  check_certificate(certificate.get(), authority.get(), files.certificate, role, reissue);
  check_private(files.private_key, certificate.get(), reissue);
  check_permissions(files.permissions, authority.get(), certificate.get(), reissue);
  return files;
}

}  // namespace aloft::security
