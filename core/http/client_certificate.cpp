// SPDX-License-Identifier: Apache-2.0
#include "core/http/client_certificate.hpp"

#include <gnutls/gnutls.h>
#include <gnutls/x509.h>
#include <microhttpd.h>

#include <array>
#include <memory>

namespace tessera::http {
namespace {

struct FreeCertificate {
  void operator()(gnutls_x509_crt_int* certificate) const { gnutls_x509_crt_deinit(certificate); }
};

bool is_trusted(gnutls_session_t session) {
  static std::array<char, sizeof GNUTLS_KP_TLS_WWW_CLIENT> purpose = {GNUTLS_KP_TLS_WWW_CLIENT};
  gnutls_typed_vdata_st wanted{};
  wanted.type = GNUTLS_DT_KEY_PURPOSE_OID;
  wanted.data = reinterpret_cast<unsigned char*>(purpose.data());
  unsigned problems = 0;
  return gnutls_certificate_verify_peers(session, &wanted, 1, &problems) == GNUTLS_E_SUCCESS && problems == 0;
}

std::string common_name(const gnutls_datum_t& der) {
  gnutls_x509_crt_t raw = nullptr;
  if (gnutls_x509_crt_init(&raw) != GNUTLS_E_SUCCESS) return {};
  const std::unique_ptr<gnutls_x509_crt_int, FreeCertificate> certificate(raw);
  if (gnutls_x509_crt_import(raw, &der, GNUTLS_X509_FMT_DER) != GNUTLS_E_SUCCESS) return {};
  std::array<char, 256> name{};
  std::size_t size = name.size();
  if (gnutls_x509_crt_get_dn_by_oid(raw, GNUTLS_OID_X520_COMMON_NAME, 0, 0, name.data(), &size) !=
      GNUTLS_E_SUCCESS)
    return {};
  return {name.data(), size};
}

}  // namespace

std::optional<std::string> verified_client_name(MHD_Connection* connection) {
  const MHD_ConnectionInfo* const info =
      MHD_get_connection_info(connection, MHD_CONNECTION_INFO_GNUTLS_SESSION);
  if (info == nullptr || info->tls_session == nullptr) return std::nullopt;
  const auto session = static_cast<gnutls_session_t>(info->tls_session);
  unsigned count = 0;
  const gnutls_datum_t* const certificates = gnutls_certificate_get_peers(session, &count);
  if (certificates == nullptr || count == 0 || !is_trusted(session)) return std::nullopt;
  return common_name(certificates[0]);
}

}  // namespace tessera::http
