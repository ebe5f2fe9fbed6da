// SPDX-License-Identifier: Apache-2.0
#include "server/http/session_handlers.hpp"

#include <fmt/format.h>

#include <utility>

#include "server/auth/credentials.hpp"
#include "server/http/answers.hpp"
#include "server/http/read_json.hpp"

namespace tessera::http_api {

namespace {

// The approximate delay of the answer to a machine that is rejected often.
constexpr std::chrono::seconds kHoldBack{1};

// Whoever may ask this may use the page.
const auth::Method& method_of(const Context& context) {
  return context.services.gate.methods().at("/tessera.v1.RenderService/GetServerInfo");
}

std::string cookie(const std::string& value, std::chrono::seconds lifetime, bool is_secure) {
  return fmt::format("{}={}; HttpOnly; SameSite=Strict; Path=/; Max-Age={}{}", kSessionCookie, value,
                     lifetime.count(), is_secure ? "; Secure" : "");
}

// A reverse proxy that ends TLS says so.
bool is_secure(const http::Request& request) {
  return request.is_secure || request.header("x-forwarded-proto") == "https";
}

Json session_json(const Context& context, const auth::Principal& caller) {
  const bool is_open = context.services.gate.is_open();
  return {{"open", is_open},
          {"principal", caller.name},
          {"role", is_open ? std::string() : std::string(auth::role_name(caller.role))}};
}

http::Response log_in(Context& context, const http::Request& request) {
  const auto body = read_body(request.body);
  if (!body) return error_response(body.error());
  const auto token = read_token(*body);
  if (!token) return error_response(token.error());
  auth::CallerShown shown{.credentials = {.token = *token}, .machine = shown_by(context, request).machine};
  auth::Rejection rejection;
  const auto admission = context.services.gate.admit(shown, method_of(context), rejection);
  if (!admission) return reject_call(context, std::move(rejection));
  http::Response response = json_response(session_json(context, admission->caller));
  if (context.services.gate.is_open()) return response;
  const std::string id = context.sessions.open(auth::digest_of_token(*token));
  response.headers.emplace_back("Set-Cookie", cookie(id, Sessions::kLifetime, is_secure(request)));
  return response;
}

http::Response log_out(Context& context, const http::Request& request) {
  context.sessions.close(request.cookie(kSessionCookie));
  http::Response response = no_content();
  response.headers.emplace_back("Set-Cookie", cookie("", std::chrono::seconds(0), is_secure(request)));
  return response;
}

// Nobody who shows nothing is rejected: that would count as an attempt.
http::Response describe(Context& context, const http::Request& request) {
  const auth::CallerShown shown = shown_by(context, request);
  const bool shows_something = !shown.credentials.token.empty() || !shown.credentials.token_digest.empty() ||
                               !shown.credentials.certificate.empty();
  const Json nobody = {{"open", false}, {"principal", nullptr}, {"role", ""}};
  if (!shows_something && !context.services.gate.is_open()) return json_response(nobody);
  auth::Rejection rejection;
  const auto admission = context.services.gate.admit(shown, method_of(context), rejection);
  if (admission) return json_response(session_json(context, admission->caller));
  // A session whose token is gone, or a certificate that has no role.
  const bool is_unknown = rejection.status.error_code() == grpc::StatusCode::UNAUTHENTICATED;
  if (is_unknown && shown.credentials.token.empty()) return json_response(nobody);
  return reject_call(context, std::move(rejection));
}

}  // namespace

http::Response handle_session(Context& context, const http::Request& request) {
  if (request.method == "POST") return log_in(context, request);
  if (request.method == "DELETE") return log_out(context, request);
  return describe(context, request);
}

http::Response reject_call(Context& context, auth::Rejection rejection) {
  http::Response prompt =
      rejection.temporary ? error_response(*rejection.temporary) : rejection_response(rejection.status);
  if (!rejection.held_back) return prompt;
  struct Delayed {
    http::Response response;
    base::FairShare::Held place;
  };
  auto delayed = std::shared_ptr<Delayed>(new Delayed{std::move(prompt), *std::move(rejection.held_back)});
  http::Response response;
  response.later = [&context, delayed](http::Respond respond) {
    context.delayed.after(kHoldBack, [delayed, respond] { respond(std::move(delayed->response)); });
  };
  return response;
}

}  // namespace tessera::http_api
