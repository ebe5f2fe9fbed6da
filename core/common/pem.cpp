// SPDX-License-Identifier: Apache-2.0
#include "core/common/pem.hpp"

#include <fmt/format.h>
#include <openssl/bio.h>
#include <openssl/err.h>
#include <openssl/pem.h>
#include <openssl/x509.h>

#include <memory>

#include "core/common/openssl_free.hpp"
#include "core/image/file_io.hpp"

namespace tessera::common {
namespace {

using core::ErrorCode;

using Bio = std::unique_ptr<BIO, FreeWith<BIO_free>>;
using Certificate = std::unique_ptr<X509, FreeWith<X509_free>>;
using Key = std::unique_ptr<EVP_PKEY, FreeWith<EVP_PKEY_free>>;

// Keys with a passphrase are refused: there is nobody to type it.
int no_passphrase(char*, int, int, void*) {
  return 0;
}

Certificate first_certificate(const std::string& pem) {
  const Bio bio(BIO_new_mem_buf(pem.data(), static_cast<int>(pem.size())));
  Certificate certificate(PEM_read_bio_X509(bio.get(), nullptr, no_passphrase, nullptr));
  ERR_clear_error();
  return certificate;
}

Key private_key(const std::string& pem) {
  const Bio bio(BIO_new_mem_buf(pem.data(), static_cast<int>(pem.size())));
  Key key(PEM_read_bio_PrivateKey(bio.get(), nullptr, no_passphrase, nullptr));
  ERR_clear_error();
  return key;
}

core::Status check_dates(const X509& certificate, const std::string& path) {
  if (X509_cmp_current_time(X509_get0_notBefore(&certificate)) > 0)
    return core::fail(ErrorCode::kInvalidArgument,
                      fmt::format("{}: the certificate is not valid yet: is the clock right?", path));
  if (X509_cmp_current_time(X509_get0_notAfter(&certificate)) < 0)
    return core::fail(ErrorCode::kInvalidArgument,
                      fmt::format("{}: the certificate has expired: make a new one", path));
  return {};
}

}  // namespace

core::Result<std::string> read_certificates(const std::string& path) {
  auto pem = core::read_file(path);
  if (!pem) return pem;
  const Certificate certificate = first_certificate(*pem);
  if (!certificate) {
    return core::fail(
        ErrorCode::kInvalidArgument,
        fmt::format("{}: there is no certificate in PEM form (-----BEGIN CERTIFICATE-----)", path));
  }
  if (const core::Status valid = check_dates(*certificate, path); !valid) return core::fail(valid.error());
  return pem;
}

core::Result<CertificateAndKey> read_certificate_and_key(const std::string& certificate_path,
                                                         const std::string& key_path) {
  auto certificates = read_certificates(certificate_path);
  if (!certificates) return core::fail(certificates.error());
  auto key_pem = core::read_file(key_path);
  if (!key_pem) return core::fail(key_pem.error());
  const Key key = private_key(*key_pem);
  if (!key) {
    return core::fail(ErrorCode::kInvalidArgument,
                      fmt::format("{}: there is no private key in PEM form without a passphrase", key_path));
  }
  if (X509_check_private_key(first_certificate(*certificates).get(), key.get()) != 1) {
    ERR_clear_error();
    return core::fail(ErrorCode::kInvalidArgument,
                      fmt::format("{}: this is not the key of {}", key_path, certificate_path));
  }
  return CertificateAndKey{*std::move(certificates), *std::move(key_pem)};
}

}  // namespace tessera::common
