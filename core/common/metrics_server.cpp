// SPDX-License-Identifier: Apache-2.0
#include "core/common/metrics_server.hpp"

#include <fmt/format.h>
#include <prometheus/text_serializer.h>

#include <chrono>
#include <utility>

#include "core/base/host_port.hpp"
#include "core/http/server.hpp"

namespace tessera::common {
namespace {

using core::ErrorCode;

constexpr int kThreads = 2;
constexpr int kMaxConnections = 64;
// A caller that is slower is disconnected.
constexpr std::chrono::seconds kReceiveTimeout{5};
constexpr int kOk = 200, kNotFound = 404, kMethodNotAllowed = 405, kServiceUnavailable = 503;
constexpr const char* kPlainText = "text/plain; charset=utf-8";
constexpr const char* kPrometheusText = "text/plain; version=0.0.4; charset=utf-8";

http::Response text_response(int status, std::string body, const char* type = kPlainText) {
  http::Response response;
  response.status = status;
  response.headers = {{"Content-Type", type}};
  response.body = std::move(body);
  return response;
}

http::Response answer(const Health::Check& check) {
  if (!check) return text_response(kNotFound, "not found\n");
  const core::Status status = check();
  if (!status) return text_response(kServiceUnavailable, status.error().message + "\n");
  return text_response(kOk, "ok\n");
}

class Pages final : public http::Handler {
 public:
  Pages(MetricsServer::Collect collect, Health health)
      : collect_(std::move(collect)), health_(std::move(health)) {}

  http::Reception receive(const http::Request& request) override {
    http::Reception reception;
    reception.max_body_bytes = 0;
    if (request.method != "GET") reception.reject = text_response(kMethodNotAllowed, "only GET\n");
    return reception;
  }
  http::Response handle(const http::Request& request) override {
    if (request.path == "/metrics")
      return text_response(kOk, prometheus::TextSerializer().Serialize(collect_()), kPrometheusText);
    if (request.path == "/healthz") return answer(health_.alive);
    if (request.path == "/readyz") return answer(health_.ready);
    return text_response(kNotFound, "not found\n");
  }

 private:
  const MetricsServer::Collect collect_;
  const Health health_;
};

}  // namespace

struct MetricsServer::Parts {
  Pages pages;
  std::unique_ptr<http::Server> server{};
};

MetricsServer::MetricsServer(std::unique_ptr<Parts> parts) : parts_(std::move(parts)) {}

MetricsServer::~MetricsServer() = default;

core::Result<std::unique_ptr<MetricsServer>> MetricsServer::start(const std::string& address, Collect collect,
                                                                  Health health) {
  if (!core::parse_host_port(address))
    return core::fail(ErrorCode::kInvalidArgument,
                      fmt::format("--metrics: must be HOST:PORT with localhost or an IP address, such as "
                                  "127.0.0.1:9464 or [::1]:9464, got '{}'",
                                  address));
  auto parts = std::make_unique<Parts>(Parts{Pages(std::move(collect), std::move(health))});
  http::ServerOptions options;
  options.address = address;
  options.threads = kThreads;
  options.max_connections = options.max_connections_per_machine = kMaxConnections;
  options.receive_timeout = kReceiveTimeout;
  auto server = http::Server::start(options, parts->pages);
  if (!server) return core::fail(server.error().within("--metrics"));
  parts->server = std::move(*server);
  return std::unique_ptr<MetricsServer>(new MetricsServer(std::move(parts)));
}

const std::string& MetricsServer::address() const {
  return parts_->server->address();
}

}  // namespace tessera::common
