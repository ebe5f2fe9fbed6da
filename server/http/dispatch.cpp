// SPDX-License-Identifier: Apache-2.0
#include "server/http/dispatch.hpp"

#include <optional>
#include <utility>

#include "server/http/answers.hpp"
#include "server/rpc/reactors.hpp"

namespace tessera::http_api {

namespace {

base::FairPool& pool_of(const rpc::Pools& pools, Where where) {
  return where == Where::kSlow ? pools.slow : pools.users;
}

core::Error error_of(const grpc::Status& status) {
  return proto::error_from_grpc(status);
}

}  // namespace

Answer guarded_answer(const std::function<Answer()>& work) {
  std::optional<Answer> answer;
  const core::Status done = rpc::guarded([&]() -> core::Status {
    answer.emplace(work());
    return {};
  });
  if (!done) return core::fail(done.error());
  return *std::move(answer);
}

http::Response finish_call(const CallPtr& call, Answer answer) {
  if (answer) answer = hold_answer(call, *std::move(answer));
  if (!answer) {
    call->timer.end(grpc_status(answer.error()));
    return error_response(answer.error());
  }
  const bool continues = answer->later || (answer->source && !answer->size_bytes);
  if (!continues) call->timer.end(grpc::Status::OK);
  return *std::move(answer);
}

http::Response answer_later(const CallPtr& call, Where where, std::function<Answer()> work) {
  http::Response response;
  response.later = [call, where, work = std::move(work)](http::Respond respond) {
    base::FairPool& pool = pool_of(call->services().pools, where);
    const bool posted = pool.post(call->caller().key, [call, &pool, work, respond] {
      Answer answer = pool.is_closed() ? Answer(core::fail(error_of(rpc::stopping()))) : guarded_answer(work);
      respond(finish_call(call, std::move(answer)));
    });
    if (!posted) respond(finish_call(call, core::fail(error_of(rpc::busy()))));
  };
  return response;
}

}  // namespace tessera::http_api
