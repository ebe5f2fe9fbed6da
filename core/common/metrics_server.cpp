// SPDX-License-Identifier: Apache-2.0
#include "core/common/metrics_server.hpp"

#include <fmt/format.h>
#include <prometheus/collectable.h>
#include <prometheus/exposer.h>

#include <exception>
#include <optional>
#include <utility>
#include <vector>

#include "core/base/host_port.hpp"

namespace tessera::common {

namespace {

using core::ErrorCode;

constexpr const char* kThreads = "2";
// A caller that is slower is disconnected, so that it does not keep a thread.
constexpr const char* kMaxMilliseconds = "5000";

// What the library is told to bind. It takes lists, TLS ports and ports of all addresses as well: nothing is
// bound but what this finds.
std::optional<std::string> port_to_bind(const std::string& address) {
  const auto at = core::parse_host_port(address);
  if (!at) return std::nullopt;
  return fmt::format(fmt::runtime(at->is_ipv6 ? "[{}]:{}" : "{}:{}"), at->host, at->port);
}

class Source final : public prometheus::Collectable {
 public:
  explicit Source(MetricsServer::Collect collect) : collect_(std::move(collect)) {}
  MetricFamilies Collect() const override { return collect_(); }

 private:
  const MetricsServer::Collect collect_;
};

}  // namespace

struct MetricsServer::Parts {
  Parts(const std::string& port, Collect collect)
      : source(std::make_shared<Source>(std::move(collect))),
        exposer(std::vector<std::string>{"listening_ports", port, "num_threads", kThreads,
                                         "request_timeout_ms", kMaxMilliseconds}) {
    exposer.RegisterCollectable(source);
  }

  std::shared_ptr<Source> source;
  prometheus::Exposer exposer;
};

MetricsServer::MetricsServer(std::unique_ptr<Parts> parts, std::string address)
    : parts_(std::move(parts)), address_(std::move(address)) {}

MetricsServer::~MetricsServer() = default;

core::Result<std::unique_ptr<MetricsServer>> MetricsServer::start(const std::string& address,
                                                                  Collect collect) {
  const auto at = port_to_bind(address);
  if (!at)
    return core::fail(ErrorCode::kInvalidArgument,
                      fmt::format("--metrics: must be HOST:PORT with localhost or an IP address, such as "
                                  "127.0.0.1:9464 or [::1]:9464, got '{}'",
                                  address));
  try {
    auto parts = std::make_unique<Parts>(*at, std::move(collect));
    const std::vector<int> ports = parts->exposer.GetListeningPorts();
    const std::string host = address.substr(0, address.rfind(':'));
    return std::unique_ptr<MetricsServer>(
        new MetricsServer(std::move(parts), fmt::format("{}:{}", host, ports.empty() ? 0 : ports.front())));
  } catch (const std::exception&) {  // it does not say why
    return core::fail(ErrorCode::kUnavailable,
                      fmt::format("cannot listen on {} for --metrics: the port is in use, or the address is "
                                  "not one of this machine",
                                  address));
  }
}

}  // namespace tessera::common
