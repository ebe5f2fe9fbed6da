// SPDX-License-Identifier: Apache-2.0
// Serves the metrics of a program to Prometheus, and its health to cluster managers: GET /metrics, /healthz
// and /readyz over HTTP, without TLS or credentials. Thread-safe.
#pragma once

#include <functional>
#include <memory>
#include <string>

#include "core/base/error.hpp"
#include "core/common/metric_writer.hpp"

namespace tessera::common {

// Each says why it is not so. They are called on threads of the server.
struct Health {
  using Check = std::function<core::Status()>;
  Check alive{};  // /healthz: the program works and need not be restarted. Empty: there is no such page
  Check ready{};  // /readyz: it does what it is for. Empty: there is no such page
};

class MetricsServer {
 public:
  // Called on threads of the server, for two callers at once at most.
  using Collect = std::function<MetricFamilies()>;

  // Listens at `address`, HOST:PORT with a numeric host, or localhost; port 0 picks a free port.
  // INVALID_ARGUMENT if it is none, UNAVAILABLE if the port is taken or the host is not this machine's.
  static core::Result<std::unique_ptr<MetricsServer>> start(const std::string& address, Collect collect,
                                                            Health health = {});
  // Waits for calls in progress.
  ~MetricsServer();

  // HOST:PORT with the actual port.
  const std::string& address() const;

 private:
  struct Parts;
  explicit MetricsServer(std::unique_ptr<Parts> parts);

  std::unique_ptr<Parts> parts_;
};

}  // namespace tessera::common
