// SPDX-License-Identifier: Apache-2.0
// The client's connection to a farm: options, and calls whose errors are user-readable messages.
// Thread-safe.
#pragma once

#include <fmt/format.h>
#include <grpcpp/client_context.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <atomic>
#include <chrono>
#include <functional>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <string_view>

#include "client/farm/interruption.hpp"
#include "client/interrupt.hpp"
#include "core/base/error.hpp"
#include "core/base/mutex.hpp"
#include "proto/channel.hpp"
#include "proto/retry.hpp"
#include "tessera/v1/admin_service.grpc.pb.h"
#include "tessera/v1/render_service.grpc.pb.h"

namespace tessera::client {

struct FarmOptions {
  std::string address = proto::kDefaultCoordinator;  // HOST:PORT
  proto::ClientSecurity security{};
  std::chrono::seconds patience{60};  // how long to retry while a coordinator restarts or is overloaded
  std::chrono::seconds start_patience{
      5};  // how long to retry without a connection, since the coordinator may be starting
};

// Adds --coordinator and the options for certificates and tokens. `options` are filled in while the command
// line is parsed, and must live until then.
void add_farm_options(CLI::App& command, FarmOptions& options);

class Farm {
 public:
  using Stub = v1::RenderService::StubInterface;
  using AdminStub = v1::AdminService::StubInterface;

  // Errors concern certificates and tokens; no connection is made yet.
  static core::Result<std::unique_ptr<Farm>> open(const FarmOptions& options);

  const std::string& address() const { return options_.address; }
  // Whether any call() has succeeded.
  bool reached() const { return reached_; }
  std::chrono::seconds patience() const { return options_.patience; }
  Stub& stub() { return *stub_; }

  // Calls a method, e.g. call(&Farm::Stub::GetJob, request). Blocks for up to `timeout`. Retries with a
  // message on stderr: without a connection for up to the start patience, and if the coordinator asks to
  // wait, for up to `timeout` or the patience.
  template <typename Request, typename Response>
  core::Result<Response> call(grpc::Status (Stub::*method)(grpc::ClientContext*, const Request&, Response*),
                              const Request& request,
                              std::chrono::seconds timeout = std::chrono::seconds(30)) {
    return call_method(*stub_, method, request, timeout);
  }
  // The same for a method of AdminService.
  template <typename Request, typename Response>
  core::Result<Response> call(grpc::Status (AdminStub::*method)(grpc::ClientContext*, const Request&,
                                                                Response*),
                              const Request& request,
                              std::chrono::seconds timeout = std::chrono::seconds(30)) {
    return call_method(*admin_stub_, method, request, timeout);
  }

  // The error message of a failed call. If no call has ever succeeded, it explains how to start a
  // coordinator.
  core::Error explain(const grpc::Status& status, const grpc::ClientContext& call) const;

  // Prints on stderr why a command retries, and for how long at most. Each reason is printed once, ignoring
  // numbers in it.
  void tell_why_waiting(const core::Error& error, std::chrono::seconds most);

 private:
  // The retry state of a call that the coordinator asks to wait.
  struct Patience {
    explicit Patience(std::chrono::seconds most)
        : total(most), until(std::chrono::steady_clock::now() + most) {}
    std::chrono::seconds total;
    std::chrono::steady_clock::time_point until;
    int waits = 0;
    // The status of a connection that was closed at once: later attempts may say less.
    std::optional<grpc::Status> closed{};
  };
  template <typename AnyStub, typename Request, typename Response>
  core::Result<Response> call_method(AnyStub& stub,
                                     grpc::Status (AnyStub::*method)(grpc::ClientContext*, const Request&,
                                                                     Response*),
                                     const Request& request, std::chrono::seconds timeout) {
    Patience patience(std::max(timeout, options_.patience)), start(options_.start_patience);
    while (true) {
      grpc::ClientContext context;
      context.set_deadline(std::chrono::system_clock::now() + timeout);
      Response response;
      const grpc::Status status = (stub.*method)(&context, request, &response);
      if (status.ok()) {
        reached_ = true;
        return response;
      }
      if (!wait_for_connection(status, start) && !wait_if_asked(status, context, patience))
        return core::fail(explain_end(status, context, start));
    }
  }
  // Waits as long as a failed call asks, with backoff. Returns false at once if the call does not ask to
  // wait or the patience is exceeded, and if interrupted.
  bool wait_if_asked(const grpc::Status& status, const grpc::ClientContext& call, Patience& patience);
  // The same for a first call that was never sent for lack of a connection.
  bool wait_for_connection(const grpc::Status& status, Patience& start);
  bool wait(std::chrono::steady_clock::duration time, const core::Error& why, const Patience& patience);
  // The error of a call that is not retried any more, after the requested wait.
  core::Error explain_end(const grpc::Status& status, const grpc::ClientContext& call,
                          const Patience& start) const;

  Farm(const FarmOptions& options, std::shared_ptr<grpc::Channel> channel);

  const FarmOptions options_;
  std::shared_ptr<grpc::Channel> channel_;
  std::unique_ptr<Stub> stub_;
  std::unique_ptr<AdminStub> admin_stub_;
  std::atomic<bool> reached_{false};
  core::Mutex mutex_;
  std::set<std::string> told_reasons_ TESSERA_GUARDED_BY(mutex_);  // numbers removed
};

// Whether the coordinator has a feature of GetServerInfo; one without that call has none.
core::Result<bool> has_feature(Farm& farm, std::string_view feature);

// Repeats `attempt`, a step of a longer task, while the coordinator restarts or asks to wait, until the
// farm's patience has passed since the last attempt with progress. Attempts report progress by setting
// their argument. If no call has ever succeeded, the first failure is returned.
template <typename T>
core::Result<T> patiently(Farm& farm, const std::function<core::Result<T>(bool& progress)>& attempt) {
  core::Result<T> result;
  bool waited = false;
  const auto backoff = proto::within(farm.patience(), proto::transient_only(proto::exponential_backoff()));
  const proto::RetryPolicy policy = [&](const proto::Attempts& attempts) {
    const auto wait = farm.reached() ? backoff(attempts) : std::nullopt;
    if (wait) farm.tell_why_waiting(result.error(), farm.patience());
    waited = waited || wait;
    return wait;
  };
  proto::Waiter waiter = proto::real_time();
  waiter.wait = sleep_unless_interrupted;
  const core::Status done = proto::retry_long(policy, waiter, [&](bool& progress) -> core::Status {
    result = attempt(progress);
    return result ? core::Status{} : core::fail(result.error());
  });
  if (done) return result;
  core::Error error = done.error();
  if (waited && proto::is_transient(error.code) && !interrupted())
    error.message += fmt::format("; this was tried for {} s", farm.patience().count());
  return core::fail(std::move(error));
}

}  // namespace tessera::client
