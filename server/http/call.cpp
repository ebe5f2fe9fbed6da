// SPDX-License-Identifier: Apache-2.0
#include "server/http/call.hpp"

#include <netinet/in.h>

#include <algorithm>
#include <cstring>

#include "proto/peer_address.hpp"
#include "server/auth/credentials.hpp"
#include "server/http/answers.hpp"

namespace tessera::http_api {

namespace {

class HeldBody final : public http::BodySource {
 public:
  HeldBody(CallPtr call, std::string body, base::FairShare::Held place)
      : call_(std::move(call)), body_(std::move(body)), place_(std::move(place)) {}

  State read(std::string& out, std::size_t max_bytes) override {
    const std::size_t count = std::min(max_bytes, body_.size() - sent_);
    out.append(body_, sent_, count);
    sent_ += count;
    return sent_ == body_.size() ? State::kEnd : State::kMore;
  }

 private:
  const CallPtr call_;
  const std::string body_;
  const base::FairShare::Held place_;
  std::size_t sent_ = 0;
};

}  // namespace

auth::CallerShown shown_by(Context& context, const http::Request& request) {
  auth::CallerShown shown{.machine = proto::client_machine(request.peer)};
  shown.credentials.token = auth::bearer_token(request.header("authorization"));
  if (shown.credentials.token.empty())
    shown.credentials.token_digest =
        context.sessions.token_digest(request.cookie(kSessionCookie)).value_or("");
  if (shown.credentials.token.empty() && shown.credentials.token_digest.empty())
    shown.credentials.certificate = request.client_name;
  return shown;
}

Answer hold_answer(const CallPtr& call, http::Response response) {
  if (response.source || response.later || response.body.empty()) return response;
  base::FairShare& answers = call->services().streams.answers;
  auto place = answers.take(call->caller().key, response.body.size());
  if (!place)
    return core::fail(server::temporary({core::ErrorCode::kResourceExhausted,
                                         "too many bytes of earlier answers to this caller were not read "
                                         "yet: read them first"},
                                        auth::kTryAgainAfter));
  response.size_bytes = response.body.size();
  response.source = std::make_unique<HeldBody>(call, std::move(response.body), *std::move(place));
  response.body.clear();
  return response;
}

}  // namespace tessera::http_api
