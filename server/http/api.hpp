// SPDX-License-Identifier: Apache-2.0
// The HTTP API of a coordinator, and its page: docs/http-api.md. Thread-safe.
#pragma once

#include <filesystem>
#include <memory>
#include <string>

#include "core/base/error.hpp"
#include "core/http/server.hpp"
#include "proto/security.hpp"
#include "server/base/periodic.hpp"
#include "server/http/call.hpp"
#include "server/http/routes.hpp"

namespace tessera::http_api {

struct ApiOptions {
  std::string address;  // HOST:PORT; port 0 picks a free one
  int socket = -1;      // see http::ServerOptions
  // The same as for gRPC: without TLS, only this machine is served, unless it is insecure.
  proto::ServerSecurity security{};
  // Where sessions outlive a restart; empty: they do not.
  std::filesystem::path sessions_file{};
};

class Api final : private http::Handler {
 public:
  // The services must outlive it. Errors name the option or the file to correct; UNAVAILABLE if the port is
  // taken.
  static core::Result<std::unique_ptr<Api>> start(const rpc::Services& services, const ApiOptions& options);
  // Ends all connections.
  ~Api() override;

  // HOST:PORT with the actual port, and "http://HOST:PORT/" or "https://...".
  const std::string& address() const { return server_->address(); }
  std::string url() const;
  // Reads the files of certificates again; see http::Server::replace_certificates().
  core::Status reload_certificates();
  // Calls by route.
  const rpc::CallStats& calls() const { return context_->calls; }

 private:
  class CallSink;

  Api(const rpc::Services& services, const ApiOptions& options);
  http::Reception receive(const http::Request& request) override;
  http::Response handle(const http::Request& request) override;

  bool is_secure() const { return !security_.certificate.empty(); }
  http::Reception receive_call(const http::Request& request);
  // The error of a request that is not for this host, or that another site makes.
  core::Status check_site(const http::Request& request, bool is_change) const;
  void note_activity();

  const std::shared_ptr<Context> context_;
  const std::string host_;  // that of the address
  const bool checks_host_;  // against DNS rebinding
  const proto::ServerSecurity security_;
  base::Periodic activity_sampler_;
  std::unique_ptr<http::Server> server_;  // last: its threads use the others
};

}  // namespace tessera::http_api
