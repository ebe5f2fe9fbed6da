// The farm a command speaks to: where it is, and calls whose errors are sentences. Thread-safe.
#pragma once

#include <grpcpp/client_context.h>

#include <CLI/CLI.hpp>
#include <atomic>
#include <chrono>
#include <functional>
#include <memory>
#include <string>

#include "client/farm/interruption.hpp"
#include "core/base/error.hpp"
#include "proto/channel.hpp"
#include "proto/retry.hpp"
#include "tessera/v1/render_service.grpc.pb.h"

namespace tessera::client {

struct FarmOptions {
  std::string address = proto::kDefaultCoordinator;  // HOST:PORT
  proto::ClientSecurity security;
};

// Adds --coordinator and what concerns certificates and tokens. `options` are filled in while the command
// line is parsed, and must live until then.
void add_farm_options(CLI::App& command, FarmOptions& options);

class Farm {
 public:
  using Stub = v1::RenderService::StubInterface;

  // Errors are about certificates and tokens; nothing is connected yet.
  static core::Result<std::unique_ptr<Farm>> open(const FarmOptions& options);

  const std::string& address() const { return options_.address; }
  Stub& stub() { return *stub_; }

  // One call of a method, e.g. call(&Farm::Stub::GetJob, request). Blocks for up to `timeout`.
  template <typename Request, typename Response>
  core::Result<Response> call(grpc::Status (Stub::*method)(grpc::ClientContext*, const Request&, Response*),
                              const Request& request,
                              std::chrono::seconds timeout = std::chrono::seconds(30)) {
    grpc::ClientContext context;
    prepare(context);
    context.set_deadline(std::chrono::system_clock::now() + timeout);
    Response response;
    const grpc::Status status = (stub_.get()->*method)(&context, request, &response);
    if (!status.ok()) return core::fail(explain(status, context));
    reached_ = true;
    return response;
  }

  // For streams: makes the call wait for a coordinator that has been reached before and is lost. The first
  // call of a command fails at once if nobody is there.
  void prepare(grpc::ClientContext& context) const { context.set_wait_for_ready(reached_); }

  // What to tell the user of a call that failed. Where nobody answered, that is how to start a coordinator.
  core::Error explain(const grpc::Status& status, const grpc::ClientContext& call) const;

 private:
  Farm(const FarmOptions& options, std::shared_ptr<grpc::Channel> channel);
  core::Error explain_unreachable(const grpc::Status& status) const;

  const FarmOptions options_;
  std::shared_ptr<grpc::Channel> channel_;
  std::unique_ptr<Stub> stub_;
  std::atomic<bool> reached_{false};
};

// `attempt` again and again while the coordinator restarts, for up to a minute. For steps of a longer task; a
// command's first call should fail at once.
template <typename T>
core::Result<T> patiently(const std::function<core::Result<T>()>& attempt) {
  core::Result<T> result;
  const auto policy =
      proto::within(std::chrono::minutes(1), proto::transient_only(proto::exponential_backoff()));
  proto::Waiter waiter = proto::real_time();
  waiter.wait = sleep_unless_interrupted;
  const core::Status done = proto::retry(policy, waiter, [&]() -> core::Status {
    result = attempt();
    return result ? core::Status{} : core::fail(result.error());
  });
  return done ? std::move(result) : core::fail(done.error());
}

}  // namespace tessera::client
