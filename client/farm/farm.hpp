// SPDX-License-Identifier: Apache-2.0
// The farm a command speaks to: where it is, and calls whose errors are sentences. Thread-safe.
#pragma once

#include <fmt/format.h>
#include <grpcpp/client_context.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <atomic>
#include <chrono>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <set>
#include <string>

#include "client/farm/interruption.hpp"
#include "client/interrupt.hpp"
#include "core/base/error.hpp"
#include "proto/channel.hpp"
#include "proto/retry.hpp"
#include "tessera/v1/render_service.grpc.pb.h"

namespace tessera::client {

struct FarmOptions {
  std::string address = proto::kDefaultCoordinator;  // HOST:PORT
  proto::ClientSecurity security;
  std::chrono::seconds patience{60};  // with a coordinator that restarts, or has too much to do
  std::chrono::seconds start_patience{
      5};  // with a coordinator that takes no connection, since it may be starting
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
  // Whether the coordinator has ever granted a call().
  bool reached() const { return reached_; }
  std::chrono::seconds patience() const { return options_.patience; }
  Stub& stub() { return *stub_; }

  // One call of a method, e.g. call(&Farm::Stub::GetJob, request). Blocks for up to `timeout`. Says so and
  // tries again where there is no connection at first, for up to the patience with a start, and where the
  // coordinator asks to wait, for up to `timeout` or its patience.
  template <typename Request, typename Response>
  core::Result<Response> call(grpc::Status (Stub::*method)(grpc::ClientContext*, const Request&, Response*),
                              const Request& request,
                              std::chrono::seconds timeout = std::chrono::seconds(30)) {
    Patience patience(std::max(timeout, options_.patience)), start(options_.start_patience);
    while (true) {
      grpc::ClientContext context;
      context.set_deadline(std::chrono::system_clock::now() + timeout);
      Response response;
      const grpc::Status status = (stub_.get()->*method)(&context, request, &response);
      if (status.ok()) {
        reached_ = true;
        return response;
      }
      if (!wait_for_connection(status, start) && !wait_if_asked(status, context, patience))
        return core::fail(explain_end(status, context, start));
    }
  }

  // What to tell the user of a call that failed. Where nobody has ever answered, that is how to start a
  // coordinator.
  core::Error explain(const grpc::Status& status, const grpc::ClientContext& call) const;

  // Says on stderr why a command waits and tries again, and for how long at most: each reason once, whatever
  // numbers are in it.
  void tell_why_waiting(const core::Error& error, std::chrono::seconds most);

 private:
  // How long a call that the coordinator asks to wait may be tried again.
  struct Patience {
    explicit Patience(std::chrono::seconds most)
        : total(most), until(std::chrono::steady_clock::now() + most) {}
    std::chrono::seconds total;
    std::chrono::steady_clock::time_point until;
    int waits = 0;
    // Of a connection that was closed at once: what later attempts say may be less.
    std::optional<grpc::Status> closed{};
  };
  // Waits as long as a call that failed asks to, and longer each time. False, and nothing happens, if it does
  // not ask, or beyond all patience; also if interrupted.
  bool wait_if_asked(const grpc::Status& status, const grpc::ClientContext& call, Patience& patience);
  // The same for a first call that was never sent, since nobody took its connection.
  bool wait_for_connection(const grpc::Status& status, Patience& start);
  bool wait(std::chrono::steady_clock::duration time, const core::Error& why, const Patience& patience);
  // Of a call that is not tried again: what it asked to wait for has been waited for.
  core::Error explain_end(const grpc::Status& status, const grpc::ClientContext& call,
                          const Patience& start) const;

  Farm(const FarmOptions& options, std::shared_ptr<grpc::Channel> channel);

  const FarmOptions options_;
  std::shared_ptr<grpc::Channel> channel_;
  std::unique_ptr<Stub> stub_;
  std::atomic<bool> reached_{false};
  std::mutex mutex_;
  std::set<std::string> told_reasons_;  // guarded by mutex_; without their numbers
};

// `attempt` again and again while the coordinator restarts or asks to wait, until the farm's patience has
// passed since the last one of which something got through: those set their argument. For steps of a longer
// task. Where nobody has ever answered, the first failure is the answer.
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
