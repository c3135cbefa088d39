#pragma once

// Inside common/security only: owning pointers to OpenSSL's objects.

#include <openssl/bio.h>
#include <openssl/evp.h>
#include <openssl/pkcs7.h>
#include <openssl/x509.h>

#include <memory>
#include <string>

namespace aloft::security::openssl {

template <auto free_function>
struct Free {
  template <class T>
  void operator()(T* object) const noexcept {
    free_function(object);
  }
};

using Bio = std::unique_ptr<BIO, Free<BIO_free_all>>;
using Key = std::unique_ptr<EVP_PKEY, Free<EVP_PKEY_free>>;
using Certificate = std::unique_ptr<X509, Free<X509_free>>;
using Extension = std::unique_ptr<X509_EXTENSION, Free<X509_EXTENSION_free>>;
using Pkcs7 = std::unique_ptr<PKCS7, Free<PKCS7_free>>;
using Number = std::unique_ptr<BIGNUM, Free<BN_free>>;

/// A BIO that reads from `text`, which must outlive it.
[[nodiscard]] Bio memory(const std::string& text);
/// What was written into a memory BIO.
[[nodiscard]] std::string text_of(BIO* bio);
/// "CN=...,OU=...,O=...", as permissions name the holder of a certificate.
[[nodiscard]] std::string subject_text(const X509* certificate);

}  // namespace aloft::security::openssl
