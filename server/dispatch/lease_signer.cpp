// SPDX-License-Identifier: Apache-2.0
#include "server/dispatch/lease_signer.hpp"

#include <fmt/format.h>
#include <openssl/evp.h>
#include <openssl/hmac.h>

#include <cstdlib>
#include <string>

namespace tessera::dispatch {

namespace {

constexpr std::size_t kTokenBytes = 16;

}  // namespace

// The text lengths come first, so that no two leases have the same message. The first word separates this use
// of the secret from others.
scheduler::LeaseToken LeaseSigner::sign(scheduler::LeaseId lease, const scheduler::WorkerId& holder,
                                        const scheduler::JobId& job) const {
  const std::string message = fmt::format("lease {} {} {} {} {}", lease.value, holder.value.size(),
                                          holder.value, job.value.size(), job.value);
  std::array<unsigned char, EVP_MAX_MD_SIZE> code{};
  const void* made =
      HMAC(EVP_sha256(), secret_.data(), static_cast<int>(sizeof(secret_)),
           reinterpret_cast<const unsigned char*>(message.data()), message.size(), code.data(), nullptr);
  if (made == nullptr) std::abort();  // only lack of memory makes it fail
  return {reinterpret_cast<const char*>(code.data()), kTokenBytes};
}

}  // namespace tessera::dispatch
