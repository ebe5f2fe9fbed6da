// The farm a command speaks to: where it is, and calls whose errors are sentences. Thread-safe.
#pragma once

#include <grpcpp/client_context.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <atomic>
#include <chrono>
#include <functional>
#include <memory>
#include <mutex>
#include <set>
#include <string>

#include "client/farm/interruption.hpp"
#include "core/base/error.hpp"
#include "proto/channel.hpp"
#include "proto/retry.hpp"
#include "tessera/v1/render_service.grpc.pb.h"

namespace tessera::client {

// With a coordinator that restarts, or has too much to do.
inline constexpr std::chrono::seconds kPatience{60};

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

  // One call of a method, e.g. call(&Farm::Stub::GetJob, request). Blocks for up to `timeout`; and where the
  // coordinator asks to wait, says so and tries again, for up to `timeout` or a minute.
  template <typename Request, typename Response>
  core::Result<Response> call(grpc::Status (Stub::*method)(grpc::ClientContext*, const Request&, Response*),
                              const Request& request,
                              std::chrono::seconds timeout = std::chrono::seconds(30)) {
    Patience patience(std::max(timeout, kPatience));
    while (true) {
      grpc::ClientContext context;
      prepare(context);
      context.set_deadline(std::chrono::system_clock::now() + timeout);
      Response response;
      const grpc::Status status = (stub_.get()->*method)(&context, request, &response);
      if (status.ok()) {
        reached_ = true;
        return response;
      }
      if (!wait_if_asked(status, context, patience)) return core::fail(explain(status, context));
    }
  }

  // For streams: makes the call wait for a coordinator that has been reached before and is lost. The first
  // call of a command fails at once if nobody is there.
  void prepare(grpc::ClientContext& context) const { context.set_wait_for_ready(reached_); }

  // What to tell the user of a call that failed. Where nobody answered, that is how to start a coordinator.
  core::Error explain(const grpc::Status& status, const grpc::ClientContext& call) const;

  // Says on stderr why a command waits and tries again: each reason once, whatever numbers are in it.
  void tell_why_waiting(const core::Error& error);

 private:
  // How long a call that the coordinator asks to wait may be tried again.
  struct Patience {
    explicit Patience(std::chrono::seconds total) : until(std::chrono::steady_clock::now() + total) {}
    std::chrono::steady_clock::time_point until;
    int waits = 0;
  };
  // Waits as long as a call that failed asks to, and longer each time. False, and nothing happens, if it does
  // not ask, or beyond all patience; also if interrupted.
  bool wait_if_asked(const grpc::Status& status, const grpc::ClientContext& call, Patience& patience);

  Farm(const FarmOptions& options, std::shared_ptr<grpc::Channel> channel);
  core::Error explain_unreachable(const grpc::Status& status) const;

  const FarmOptions options_;
  std::shared_ptr<grpc::Channel> channel_;
  std::unique_ptr<Stub> stub_;
  std::atomic<bool> reached_{false};
  std::mutex mutex_;
  std::set<std::string> told_reasons_;  // guarded by mutex_; without their numbers
};

// `attempt` again and again while the coordinator restarts or asks to wait, for up to a minute after the last
// one of which something got through: those set their argument. For steps of a longer task; a command's first
// call should fail at once where nobody answers.
template <typename T>
core::Result<T> patiently(Farm& farm, const std::function<core::Result<T>(bool& progress)>& attempt) {
  core::Result<T> result;
  const auto backoff = proto::within(kPatience, proto::transient_only(proto::exponential_backoff()));
  const proto::RetryPolicy policy = [&](const proto::Attempts& attempts) {
    const auto wait = backoff(attempts);
    if (wait) farm.tell_why_waiting(result.error());
    return wait;
  };
  proto::Waiter waiter = proto::real_time();
  waiter.wait = sleep_unless_interrupted;
  const core::Status done = proto::retry_long(policy, waiter, [&](bool& progress) -> core::Status {
    result = attempt(progress);
    return result ? core::Status{} : core::fail(result.error());
  });
  return done ? std::move(result) : core::fail(done.error());
}

}  // namespace tessera::client
