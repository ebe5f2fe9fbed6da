// SPDX-License-Identifier: Apache-2.0
#include "server/dispatch/lease_signer.hpp"

#include <fmt/format.h>
#include <openssl/core_names.h>
#include <openssl/params.h>

#include <cstdlib>
#include <string>

namespace tessera::dispatch {

namespace {

constexpr std::size_t kTokenBytes = 16;

// Only lack of memory makes OpenSSL fail here.
void expect(bool done) {
  if (!done) std::abort();
}

EVP_MAC_CTX* hmac_with(const LeaseSigner::Secret& secret) {
  EVP_MAC* const hmac = EVP_MAC_fetch(nullptr, OSSL_MAC_NAME_HMAC, nullptr);
  expect(hmac != nullptr);
  EVP_MAC_CTX* const context = EVP_MAC_CTX_new(hmac);
  EVP_MAC_free(hmac);
  std::string digest = "SHA256";
  const std::array parameters{OSSL_PARAM_construct_utf8_string(OSSL_MAC_PARAM_DIGEST, digest.data(), 0),
                              OSSL_PARAM_construct_end()};
  expect(context != nullptr && EVP_MAC_init(context, reinterpret_cast<const unsigned char*>(secret.data()),
                                            sizeof(secret), parameters.data()) == 1);
  return context;
}

}  // namespace

LeaseSigner::LeaseSigner(const Secret& secret) : mac_(hmac_with(secret), &EVP_MAC_CTX_free) {}

// The text lengths come first, so that no two leases have the same message. The first word separates this use
// of the secret from others.
scheduler::LeaseToken LeaseSigner::sign(scheduler::LeaseId lease, const scheduler::WorkerId& holder,
                                        const scheduler::JobId& job) const {
  const std::string message = fmt::format("lease {} {} {} {} {}", lease.value, holder.value.size(),
                                          holder.value, job.value.size(), job.value);
  std::array<unsigned char, EVP_MAX_MD_SIZE> code{};
  std::size_t written = 0;
  {
    const core::MutexLock lock(mutex_);
    expect(EVP_MAC_init(mac_.get(), nullptr, 0, nullptr) == 1);  // with the same secret again
    expect(EVP_MAC_update(mac_.get(), reinterpret_cast<const unsigned char*>(message.data()),
                          message.size()) == 1);
    expect(EVP_MAC_final(mac_.get(), code.data(), &written, code.size()) == 1 && written >= kTokenBytes);
  }
  return {reinterpret_cast<const char*>(code.data()), kTokenBytes};
}

}  // namespace tessera::dispatch
