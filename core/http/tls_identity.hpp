// SPDX-License-Identifier: Apache-2.0
// The certificate of a server, and the CAs of its clients' certificates. Immutable: a server that gets other
// ones has another identity, and connections keep theirs. Thread-safe.
#pragma once

#include <gnutls/abstract.h>
#include <gnutls/gnutls.h>
#include <gnutls/x509.h>

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/base/error.hpp"
#include "core/http/server.hpp"

namespace tessera::http {

class TlsIdentity {
 public:
  // INVALID_ARGUMENT, as GnuTLS says it, for a certificate, key or CA that it cannot use.
  static core::Result<std::shared_ptr<const TlsIdentity>> make(const TlsOptions& options);
  TlsIdentity(const TlsIdentity&) = delete;
  TlsIdentity& operator=(const TlsIdentity&) = delete;
  ~TlsIdentity();

  // A session shows this certificate if its credentials have retrieve(), and use() is called before its
  // handshake. The identity must outlive the session.
  void use(gnutls_session_t session) const;
  static int retrieve(gnutls_session_t session, const gnutls_datum_t* ca_names, int ca_name_count,
                      const gnutls_pk_algorithm_t* algorithms, int algorithm_count,
                      gnutls_pcert_st** certificates, unsigned* certificate_count, gnutls_privkey_t* key);

  const std::string& client_ca_pem() const { return client_ca_pem_; }
  bool needs_client_certificate() const { return !client_ca_pem_.empty(); }
  // The common name of the client's certificate, empty if it has none. Nothing if the client has presented no
  // certificate, or one that none of the CAs has signed for clients, or that is not valid now.
  std::optional<std::string> verified_client_name(gnutls_session_t session) const;

 private:
  explicit TlsIdentity(std::string client_ca_pem) : client_ca_pem_(std::move(client_ca_pem)) {}
  // The results of GnuTLS: negative on failure.
  int load(const TlsOptions& options);
  int load_certificates(const std::string& pem);
  int load_key(const std::string& pem);
  int load_client_cas();

  const std::string client_ca_pem_;
  std::vector<gnutls_pcert_st> certificates_;  // the server's, then those that signed it
  gnutls_privkey_t key_ = nullptr;
  gnutls_x509_trust_list_t client_cas_ = nullptr;
};

}  // namespace tessera::http
