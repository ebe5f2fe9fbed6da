// SPDX-License-Identifier: Apache-2.0
#include "worker/peer_certificate.hpp"

#include <openssl/bio.h>
#include <openssl/ec.h>
#include <openssl/evp.h>
#include <openssl/pem.h>
#include <openssl/x509.h>
#include <openssl/x509v3.h>

#include <functional>
#include <memory>
#include <stdexcept>

#include "core/common/openssl_free.hpp"
#include "proto/peer_ticket.hpp"

namespace tessera::worker {

namespace {

// Clocks of hosts differ. The certificate is trusted for being the one that the coordinator has named, not
// for its dates.
constexpr long kDaySeconds = 86400;
constexpr long kValidSeconds = 3650 * kDaySeconds;
constexpr long kVersion3 = 2;
constexpr std::size_t kMaxPemBytes = 4 << 10;

using common::FreeWith;
using Key = std::unique_ptr<EVP_PKEY, FreeWith<EVP_PKEY_free>>;
using Certificate = std::unique_ptr<X509, FreeWith<X509_free>>;
using Extension = std::unique_ptr<X509_EXTENSION, FreeWith<X509_EXTENSION_free>>;
using Bio = std::unique_ptr<BIO, FreeWith<BIO_free_all>>;

void require(bool done) {
  if (!done) throw std::runtime_error("OpenSSL cannot make a certificate");
}

void add_extension(X509& certificate, int id, const std::string& value) {
  const Extension extension(X509V3_EXT_conf_nid(nullptr, nullptr, id, value.c_str()));
  require(extension && X509_add_ext(&certificate, extension.get(), -1) == 1);
}

std::string written(const std::function<int(BIO*)>& write) {
  const Bio memory(BIO_new(BIO_s_mem()));
  require(memory && write(memory.get()) == 1);
  std::string text(kMaxPemBytes, '\0');
  const int size = BIO_read(memory.get(), text.data(), static_cast<int>(text.size()));
  require(size > 0 && size < static_cast<int>(text.size()));
  text.resize(static_cast<std::size_t>(size));
  return text;
}

}  // namespace

PeerCertificate make_peer_certificate() {
  const Key key(EVP_PKEY_Q_keygen(nullptr, nullptr, "EC", "P-256"));
  const Certificate certificate(X509_new());
  require(key && certificate);
  X509& x509 = *certificate;
  X509_NAME* const name = X509_get_subject_name(&x509);
  require(X509_set_version(&x509, kVersion3) == 1 && ASN1_INTEGER_set(X509_get_serialNumber(&x509), 1) == 1 &&
          X509_gmtime_adj(X509_getm_notBefore(&x509), -kDaySeconds) != nullptr &&
          X509_gmtime_adj(X509_getm_notAfter(&x509), kValidSeconds) != nullptr &&
          X509_set_pubkey(&x509, key.get()) == 1 &&
          X509_NAME_add_entry_by_txt(name, "CN", MBSTRING_ASC,
                                     reinterpret_cast<const unsigned char*>(proto::kPeerName), -1, -1,
                                     0) == 1 &&
          X509_set_issuer_name(&x509, name) == 1);
  add_extension(x509, NID_basic_constraints, "critical,CA:TRUE");
  add_extension(x509, NID_subject_alt_name, std::string("DNS:") + proto::kPeerName);
  require(X509_sign(&x509, key.get(), EVP_sha256()) > 0);
  return {written([&](BIO* bio) { return PEM_write_bio_X509(bio, &x509); }), written([&](BIO* bio) {
            return PEM_write_bio_PrivateKey(bio, key.get(), nullptr, nullptr, 0, nullptr, nullptr);
          })};
}

}  // namespace tessera::worker
