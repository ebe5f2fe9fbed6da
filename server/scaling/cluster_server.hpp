// SPDX-License-Identifier: Apache-2.0
// The port for cluster managers: the health service of gRPC and the external scaler, without TLS or
// credentials, since the probes of Kubernetes have neither. It tells sums over the farm and changes nothing.
// Thread-safe.
#pragma once

#include <functional>
#include <memory>
#include <string>

#include "core/base/error.hpp"
#include "server/farm/totals.hpp"

namespace tessera::scaling {

// The names that the health service knows, beside the empty one for the whole server. Alive: the state lock
// was held by the probe within the last minute. Ready: within the last five seconds.
inline constexpr const char* kLiveness = "liveness";
inline constexpr const char* kReadiness = "readiness";

class ClusterServer {
 public:
  using ReadTotals = std::function<farm::Totals()>;

  // Listens at HOST:PORT; port 0 picks a free port. UNAVAILABLE if it cannot. `read_totals` is called once a
  // second, on one thread.
  static core::Result<std::unique_ptr<ClusterServer>> start(const std::string& address,
                                                            ReadTotals read_totals);
  // Reports that it is not ready, and ends calls in progress.
  ~ClusterServer();

  // HOST:PORT with the actual port.
  const std::string& address() const { return address_; }

 private:
  struct Parts;
  ClusterServer(std::unique_ptr<Parts> parts, std::string address);

  std::unique_ptr<Parts> parts_;
  const std::string address_;
};

}  // namespace tessera::scaling
