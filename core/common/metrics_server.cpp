// SPDX-License-Identifier: Apache-2.0
#include "core/common/metrics_server.hpp"

#include <arpa/inet.h>
#include <fmt/format.h>
#include <prometheus/collectable.h>
#include <prometheus/exposer.h>

#include <charconv>
#include <exception>
#include <optional>
#include <utility>
#include <vector>

namespace tessera::common {

namespace {

using core::ErrorCode;

constexpr const char* kThreads = "2";
// A caller that is slower is disconnected, so that it does not keep a thread.
constexpr const char* kMostMilliseconds = "5000";

struct HostAndPort {
  std::string host;  // as it is bound: an IPv6 address in brackets
  std::string port;
};

bool is_ip(int family, const std::string& host) {
  in6_addr parsed{};
  return inet_pton(family, host.c_str(), &parsed) == 1;
}

std::optional<std::string> host_to_bind(const std::string& host) {
  if (host == "localhost") return "127.0.0.1";
  if (is_ip(AF_INET, host)) return host;
  const bool in_brackets = host.size() > 2 && host.front() == '[' && host.back() == ']';
  if (in_brackets && is_ip(AF_INET6, host.substr(1, host.size() - 2))) return host;
  return std::nullopt;
}

// The library takes lists, TLS ports and ports of all addresses as well: nothing is bound but what this
// finds.
std::optional<HostAndPort> parse(const std::string& address) {
  const std::size_t colon = address.rfind(':');
  if (colon == std::string::npos) return std::nullopt;
  const std::string port = address.substr(colon + 1);
  std::uint16_t number = 0;
  const auto [end, wrong] = std::from_chars(port.data(), port.data() + port.size(), number);
  const auto host = host_to_bind(address.substr(0, colon));
  if (!host || wrong != std::errc() || end != port.data() + port.size()) return std::nullopt;
  return HostAndPort{*host, port};
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
  Parts(const HostAndPort& at, Collect collect)
      : source(std::make_shared<Source>(std::move(collect))),
        exposer(std::vector<std::string>{"listening_ports", at.host + ":" + at.port, "num_threads", kThreads,
                                         "request_timeout_ms", kMostMilliseconds}) {
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
  const auto at = parse(address);
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
