// SPDX-License-Identifier: Apache-2.0
#include "server/http/api.hpp"

#include <fmt/format.h>

#include <utility>

#include "core/common/pem.hpp"
#include "core/view/security_headers.hpp"
#include "server/http/answers.hpp"
#include "server/http/dispatch.hpp"
#include "server/http/origin.hpp"
#include "server/http/session_handlers.hpp"
#include "server/http/static_pages.hpp"

namespace tessera::http_api {

namespace {

constexpr std::size_t kMaxSessionBytes = 4 << 10;
constexpr std::string_view kApiPath = "/api/";

core::Result<http::TlsOptions> read_certificates(const proto::ServerSecurity& security) {
  http::TlsOptions tls;
  if (security.certificate.empty()) return tls;
  auto mine = common::read_certificate_and_key(security.certificate, security.key);
  if (!mine) return core::fail(mine.error());
  tls.certificate_pem = std::move(mine->certificates);
  tls.key_pem = std::move(mine->key);
  if (security.client_ca.empty()) return tls;
  auto ca = common::read_certificates(security.client_ca);
  if (!ca) return core::fail(ca.error());
  tls.client_ca_pem = *std::move(ca);
  return tls;
}

core::Result<http::ServerOptions> server_options(const ApiOptions& options) {
  // Whatever gRPC refuses to serve is refused here, too. Connections without certificates cannot exhaust the
  // memory of this server.
  proto::ServerSecurity security = options.security;
  security.allow_unauthenticated = true;
  if (const auto possible = proto::server_credentials(options.address, security); !possible)
    return core::fail(possible.error().within("--http"));
  auto tls = read_certificates(security);
  if (!tls) return core::fail(tls.error());
  return http::ServerOptions{.address = options.address, .socket = options.socket, .tls = *std::move(tls)};
}

http::Reception reject(http::Response response) {
  view::add_security_headers(response);
  return {.reject = std::move(response)};
}

http::Response no_route(const FoundRoute& found) {
  if (found.allowed.empty())
    return error_response({core::ErrorCode::kNotFound, "there is no such path: docs/http-api.md has them"});
  http::Response response = error_response(
      {core::ErrorCode::kInvalidArgument, fmt::format("this path has only {}", found.allowed)});
  response.status = 405;
  response.headers.emplace_back("Allow", found.allowed);
  return response;
}

// Responses that come later get the headers, too.
http::Response with_security_headers(http::Response response) {
  if (!response.later) {
    view::add_security_headers(response);
    return response;
  }
  response.later = [later = std::move(response.later)](http::Respond respond) {
    later([respond](http::Response made) { respond(with_security_headers(std::move(made))); });
  };
  return response;
}

}  // namespace

// Takes the body of a call that is admitted, and answers it.
class Api::CallSink final : public http::BodySink {
 public:
  CallSink(const Route& route, CallPtr call, std::unique_ptr<http::BodySink> sink)
      : route_(route), call_(std::move(call)), sink_(std::move(sink)) {}

  core::Status write(std::string_view bytes) override {
    if (sink_) return sink_->write(bytes);
    if (call_->request.body.size() + bytes.size() > route_.max_body_bytes)
      return core::fail(core::ErrorCode::kInvalidArgument,
                        fmt::format("the body may have {} bytes", route_.max_body_bytes));
    call_->request.body.append(bytes);
    return {};
  }
  http::Response finish(const core::Status& status) override { return with_security_headers(answer(status)); }

 private:
  http::Response answer(const core::Status& status) {
    if (sink_) return sink_->finish(status);
    if (!status) return finish_call(call_, core::fail(status.error()));
    const auto work = [route = &route_, call = call_] { return route->answer(call); };
    if (route_.where == Where::kHere) return finish_call(call_, guarded_answer(work));
    return answer_later(call_, route_.where, work);
  }

  const Route& route_;
  const CallPtr call_;
  const std::unique_ptr<http::BodySink> sink_;  // null if the body is kept
};

Api::Api(const rpc::Services& services, const ApiOptions& options)
    : context_(std::make_shared<Context>(services, route_names(), options.sessions_file)),
      host_(host_of(options.address)),
      checks_host_(services.facts.is_open && proto::is_loopback(options.address)),
      security_(options.security),
      activity_sampler_(ActivityLog::kPeriod, [this] { note_activity(); }) {
  note_activity();
}

Api::~Api() {
  server_.reset();
}

core::Result<std::unique_ptr<Api>> Api::start(const rpc::Services& services, const ApiOptions& options) {
  const auto server = server_options(options);
  if (!server) return core::fail(server.error());
  std::unique_ptr<Api> api(new Api(services, options));
  auto started = http::Server::start(*server, *api);
  if (!started) return core::fail(started.error());
  api->server_ = std::move(*started);
  return api;
}

std::string Api::url() const {
  return fmt::format("{}://{}/", is_secure() ? "https" : "http", address());
}

core::Status Api::reload_certificates() {
  if (!is_secure()) return {};
  const auto tls = read_certificates(security_);
  return tls ? server_->replace_certificates(*tls) : core::fail(tls.error());
}

core::Status Api::check_site(const http::Request& request, bool is_change) const {
  if (checks_host_)
    if (auto fine = check_host(request, host_); !fine) return fine;
  return is_change ? check_origin(request) : core::Status();
}

void Api::note_activity() {
  context_->activity.add(activity_of(farm::totals_of(context_->services.coordinator.farm())));
}

http::Reception Api::receive(const http::Request& request) {
  const bool is_session = request.path == kSessionPath;
  if (!is_session && request.path.starts_with(kApiPath)) return receive_call(request);
  const bool is_change = is_session && request.method != "GET";
  if (auto fine = check_site(request, is_change); !fine) return reject(error_response(fine.error()));
  return {.max_body_bytes = kMaxSessionBytes};
}

http::Reception Api::receive_call(const http::Request& request) {
  FoundRoute found = find_route(request.method, request.path);
  if (found.route == nullptr) return reject(no_route(found));
  const Route& route = *found.route;
  if (auto fine = check_site(request, route.is_change()); !fine) return reject(error_response(fine.error()));
  auth::Rejection rejection;
  const auth::Method& method = context_->services.gate.methods().at(route.method_path());
  auto admission = context_->services.gate.admit(shown_by(*context_, request), method, rejection);
  if (!admission) {
    context_->services.streams.calls.note_rejected(rejection.status);
    return {.reject = with_security_headers(reject_call(*context_, std::move(rejection)))};
  }
  auto call = std::make_shared<Call>(context_, request, *std::move(admission), route.name());
  call->names = std::move(found.names);
  std::unique_ptr<http::BodySink> sink;
  if (route.receive != nullptr) {
    auto made = route.receive(call);
    if (!made) return reject(finish_call(call, core::fail(made.error())));
    sink = *std::move(made);
  }
  return {.sink = std::make_unique<CallSink>(route, std::move(call), std::move(sink))};
}

http::Response Api::handle(const http::Request& request) {
  if (request.path == kSessionPath) return with_security_headers(handle_session(*context_, request));
  return serve_page(request, context_->services.readiness);
}

}  // namespace tessera::http_api
