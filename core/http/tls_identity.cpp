// SPDX-License-Identifier: Apache-2.0
#include "core/http/tls_identity.hpp"

#include <algorithm>
#include <array>
#include <utility>

namespace tessera::http {
namespace {

constexpr unsigned kMaxChain = 16;
// As for the priorities NORMAL. The macro of GnuTLS that shifts it has a cast of C.
constexpr unsigned kVerifyFlags = static_cast<unsigned>(GNUTLS_PROFILE_LOW) << 24;

gnutls_datum_t datum_of(const std::string& text) {
  return {reinterpret_cast<unsigned char*>(const_cast<char*>(text.data())),
          static_cast<unsigned>(text.size())};
}

// Whether a server can use the two together.
int check_pair(const std::string& certificate_pem, const std::string& key_pem) {
  gnutls_certificate_credentials_t credentials = nullptr;
  if (const int made = gnutls_certificate_allocate_credentials(&credentials); made < 0) return made;
  const gnutls_datum_t certificate = datum_of(certificate_pem), key = datum_of(key_pem);
  const int set = gnutls_certificate_set_x509_key_mem(credentials, &certificate, &key, GNUTLS_X509_FMT_PEM);
  gnutls_certificate_free_credentials(credentials);
  return std::min(set, 0);
}

// The certificates that the client has presented, its own first.
class ClientChain {
 public:
  explicit ClientChain(gnutls_session_t session) {
    unsigned count = 0;
    const gnutls_datum_t* const presented = gnutls_certificate_get_peers(session, &count);
    for (unsigned i = 0; presented != nullptr && i < std::min(count, kMaxChain); ++i) {
      gnutls_x509_crt_t certificate = nullptr;
      if (gnutls_x509_crt_init(&certificate) < 0) return;
      certificates_.push_back(certificate);
      if (gnutls_x509_crt_import(certificate, &presented[i], GNUTLS_X509_FMT_DER) < 0) return;
    }
    is_readable_ = !certificates_.empty();
  }
  ClientChain(const ClientChain&) = delete;
  ClientChain& operator=(const ClientChain&) = delete;
  ~ClientChain() {
    for (gnutls_x509_crt_t certificate : certificates_) gnutls_x509_crt_deinit(certificate);
  }

  bool is_signed_by(gnutls_x509_trust_list_t cas) {
    static std::array<char, sizeof GNUTLS_KP_TLS_WWW_CLIENT> purpose = {GNUTLS_KP_TLS_WWW_CLIENT};
    gnutls_typed_vdata_st wanted{};
    wanted.type = GNUTLS_DT_KEY_PURPOSE_OID;
    wanted.data = reinterpret_cast<unsigned char*>(purpose.data());
    unsigned problems = 0;
    return is_readable_ &&
           gnutls_x509_trust_list_verify_crt2(cas, certificates_.data(),
                                              static_cast<unsigned>(certificates_.size()), &wanted, 1,
                                              kVerifyFlags, &problems, nullptr) == GNUTLS_E_SUCCESS &&
           problems == 0;
  }

  std::string common_name() const {
    std::array<char, 256> name{};
    std::size_t size = name.size();
    if (gnutls_x509_crt_get_dn_by_oid(certificates_.front(), GNUTLS_OID_X520_COMMON_NAME, 0, 0, name.data(),
                                      &size) != GNUTLS_E_SUCCESS)
      return {};
    return {name.data(), size};
  }

 private:
  std::vector<gnutls_x509_crt_t> certificates_;
  bool is_readable_ = false;
};

}  // namespace

core::Result<std::shared_ptr<const TlsIdentity>> TlsIdentity::make(const TlsOptions& options) {
  const std::shared_ptr<TlsIdentity> made(new TlsIdentity(options.client_ca_pem));
  if (const int loaded = made->load(options); loaded < 0)
    return core::fail(core::ErrorCode::kInvalidArgument, gnutls_strerror(loaded));
  return made;
}

TlsIdentity::~TlsIdentity() {
  for (gnutls_pcert_st& certificate : certificates_) gnutls_pcert_deinit(&certificate);
  if (key_ != nullptr) gnutls_privkey_deinit(key_);
  if (client_cas_ != nullptr) gnutls_x509_trust_list_deinit(client_cas_, 1);
}

int TlsIdentity::load(const TlsOptions& options) {
  if (const int fits = check_pair(options.certificate_pem, options.key_pem); fits < 0) return fits;
  if (const int loaded = load_certificates(options.certificate_pem); loaded < 0) return loaded;
  if (const int loaded = load_key(options.key_pem); loaded < 0) return loaded;
  return needs_client_certificate() ? load_client_cas() : GNUTLS_E_SUCCESS;
}

int TlsIdentity::load_certificates(const std::string& pem) {
  const gnutls_datum_t text = datum_of(pem);
  std::vector<gnutls_pcert_st> chain(kMaxChain);
  unsigned count = kMaxChain;
  const int loaded = gnutls_pcert_list_import_x509_raw(chain.data(), &count, &text, GNUTLS_X509_FMT_PEM,
                                                       GNUTLS_X509_CRT_LIST_SORT);
  if (loaded < 0) return loaded;
  chain.resize(count);
  certificates_ = std::move(chain);
  return loaded;
}

int TlsIdentity::load_key(const std::string& pem) {
  if (const int made = gnutls_privkey_init(&key_); made < 0) return made;
  const gnutls_datum_t text = datum_of(pem);
  return gnutls_privkey_import_x509_raw(key_, &text, GNUTLS_X509_FMT_PEM, nullptr, 0);
}

int TlsIdentity::load_client_cas() {
  if (const int made = gnutls_x509_trust_list_init(&client_cas_, 0); made < 0) return made;
  const gnutls_datum_t text = datum_of(client_ca_pem_);
  return gnutls_x509_trust_list_add_trust_mem(client_cas_, &text, nullptr, GNUTLS_X509_FMT_PEM, 0, 0);
}

void TlsIdentity::use(gnutls_session_t session) const {
  gnutls_session_set_ptr(session, const_cast<TlsIdentity*>(this));
}

int TlsIdentity::retrieve(gnutls_session_t session, const gnutls_datum_t*, int, const gnutls_pk_algorithm_t*,
                          int, gnutls_pcert_st** certificates, unsigned* certificate_count,
                          gnutls_privkey_t* key) {
  auto* const self = static_cast<TlsIdentity*>(gnutls_session_get_ptr(session));
  *certificates = self->certificates_.data();
  *certificate_count = static_cast<unsigned>(self->certificates_.size());
  *key = self->key_;
  return 0;
}

std::optional<std::string> TlsIdentity::verified_client_name(gnutls_session_t session) const {
  ClientChain chain(session);
  if (!chain.is_signed_by(client_cas_)) return std::nullopt;
  return chain.common_name();
}

}  // namespace tessera::http
