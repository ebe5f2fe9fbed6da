// SPDX-License-Identifier: Apache-2.0
#include "client/farm/farm.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "client/console.hpp"
#include "client/interrupt.hpp"
#include "core/common/secret_file.hpp"
#include "proto/security_flags.hpp"
#include "proto/status.hpp"
#include "proto/unreachable.hpp"

namespace tessera::client {
namespace {

// A coordinator accepts connections a fraction of a second after it was started.
constexpr std::chrono::milliseconds kLongestStartPause{500};

}  // namespace

void add_farm_options(CLI::App& command, FarmOptions& options) {
  command.add_option("--coordinator", options.address, "Address of the farm's coordinator")
      ->envname(proto::kCoordinatorVariable)
      ->type_name("HOST:PORT")
      ->capture_default_str()
      ->group("Farm");
  proto::add_security_flags(command, options.security);
}

Farm::Farm(const FarmOptions& options, std::shared_ptr<grpc::Channel> channel)
    : options_(options),
      channel_(std::move(channel)),
      stub_(v1::RenderService::NewStub(channel_)),
      admin_stub_(v1::AdminService::NewStub(channel_)) {}

core::Result<std::unique_ptr<Farm>> Farm::open(const FarmOptions& options) {
  for (const std::string& secret : {options.security.key, options.security.token})
    if (const auto warning = common::exposure_of(secret)) print_warning(*warning);
  auto channel = proto::open_channel(options.address, options.security);
  if (!channel) return core::fail(channel.error());
  return std::unique_ptr<Farm>(new Farm(options, *std::move(channel)));
}

bool Farm::wait_if_asked(const grpc::Status& status, const grpc::ClientContext& call, Patience& patience) {
  const auto asked = proto::asked_wait(status, call);
  if (!asked) return false;
  const auto pause =
      std::max<proto::Duration>(*asked, *proto::exponential_backoff()({.count = ++patience.waits}));
  return wait(pause, explain(status, call), patience);
}

bool Farm::wait_for_connection(const grpc::Status& status, Patience& start) {
  if (reached_ || !proto::may_be_starting(status)) return false;
  if (proto::is_closed_at_once(status)) start.closed = status;
  const auto pause = *proto::exponential_backoff({.longest = kLongestStartPause})({.count = ++start.waits});
  return wait(pause,
              {core::ErrorCode::kUnavailable, "no connection to the coordinator at " + address() + " yet"},
              start);
}

bool Farm::wait(std::chrono::steady_clock::duration time, const core::Error& why, const Patience& patience) {
  if (std::chrono::steady_clock::now() + time > patience.until) return false;
  tell_why_waiting(why, patience.total);
  return sleep_unless_interrupted(time);
}

core::Error Farm::explain_end(const grpc::Status& status, const grpc::ClientContext& call,
                              const Patience& start) const {
  const bool was_closed = !reached_ && start.closed && proto::is_no_connection(status);
  core::Error error = explain(was_closed ? *start.closed : status, call);
  if (proto::asked_wait(status, call)) error.code = core::ErrorCode::kResourceExhausted;
  if (start.waits > 1 && !reached_ && proto::may_be_starting(status) && !interrupted())
    error.message += fmt::format("; this was tried for {} s", start.total.count());
  return error;
}

void Farm::tell_why_waiting(const core::Error& error, std::chrono::seconds most) {
  std::string reason = error.message;
  std::erase_if(reason, [](char c) { return c >= '0' && c <= '9'; });
  const core::MutexLock lock(mutex_);
  if (told_reasons_.insert(std::move(reason)).second)
    print_warning(fmt::format("{}; trying again for up to {} s", error.message, most.count()));
}

core::Error Farm::explain(const grpc::Status& status, const grpc::ClientContext& call) const {
  const bool connected = channel_->GetState(false) == GRPC_CHANNEL_READY;
  if (status.error_code() == grpc::StatusCode::UNAVAILABLE && !connected) {
    return reached_ ? proto::explain_loss(status, address())
                    : proto::explain_no_connection(status, address(), options_.security);
  }
  if (status.error_code() == grpc::StatusCode::DEADLINE_EXCEEDED)
    return {core::ErrorCode::kDeadlineExceeded,
            fmt::format("the coordinator at {} did not answer in time: try again, or look at its log",
                        address())};
  if (status.error_code() == grpc::StatusCode::CANCELLED && !interrupted())
    return {
        core::ErrorCode::kUnavailable,
        fmt::format("the coordinator at {} ended the call: it is stopping, or for long too little of what "
                    "it sent was taken here (tessera-coordinator --stall-seconds)",
                    address())};
  core::Error error = proto::error_from_grpc(status, call);
  if (error.message.find("SERVER: Received message larger") != std::string::npos)
    error.message += "; this farm takes no larger messages (tessera-coordinator --max-message-mib)";
  return error;
}

core::Result<bool> has_feature(Farm& farm, std::string_view feature) {
  const auto info = farm.call(&Farm::Stub::GetServerInfo, v1::GetServerInfoRequest());
  if (info) return std::ranges::count(info->features(), feature) > 0;
  if (info.error().code == core::ErrorCode::kFailedPrecondition) return false;  // an early release
  return core::fail(info.error());
}

}  // namespace tessera::client
