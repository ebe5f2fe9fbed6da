// SPDX-License-Identifier: Apache-2.0
// Signs leases (scheduler::SignLease): the token, HMAC-SHA256 of lease, worker and job under the farm's
// secret, proves that a lease was given to a worker. The state directory keeps the secret, so that tokens
// stay valid across restarts of the coordinator. Thread-safe.
#pragma once

#include <openssl/evp.h>

#include <array>
#include <cstdint>
#include <memory>

#include "core/base/mutex.hpp"
#include "server/scheduler/types.hpp"

namespace tessera::dispatch {

class LeaseSigner {
 public:
  using Secret = std::array<std::uint64_t, 2>;

  explicit LeaseSigner(const Secret& secret);

  // Returns 16 bytes.
  scheduler::LeaseToken sign(scheduler::LeaseId lease, const scheduler::WorkerId& holder,
                             const scheduler::JobId& job) const;

 private:
  mutable core::Mutex mutex_;
  // Has the secret. Looking up the algorithm for each token would take longer than the token.
  const std::unique_ptr<EVP_MAC_CTX, decltype(&EVP_MAC_CTX_free)> mac_ TESSERA_GUARDED_BY(mutex_);
};

}  // namespace tessera::dispatch
