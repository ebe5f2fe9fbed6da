#include "client/farm/farm.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "client/console.hpp"
#include "client/interrupt.hpp"
#include "proto/security_flags.hpp"
#include "proto/status.hpp"

namespace tessera::client {

void add_farm_options(CLI::App& command, FarmOptions& options) {
  command.add_option("--coordinator", options.address, "Where the farm's coordinator listens")
      ->envname(proto::kCoordinatorVariable)
      ->option_text(fmt::format("HOST:PORT [{}]", options.address));
  proto::add_security_flags(command, options.security);
}

Farm::Farm(const FarmOptions& options, std::shared_ptr<grpc::Channel> channel)
    : options_(options), channel_(std::move(channel)), stub_(v1::RenderService::NewStub(channel_)) {}

core::Result<std::unique_ptr<Farm>> Farm::open(const FarmOptions& options) {
  auto channel = proto::open_channel(options.address, options.security);
  if (!channel) return core::fail(channel.error());
  return std::unique_ptr<Farm>(new Farm(options, *std::move(channel)));
}

bool Farm::wait_if_asked(const grpc::Status& status, const grpc::ClientContext& call, Patience& patience) {
  const auto asked = proto::asked_wait(status, call);
  if (!asked) return false;
  const auto wait =
      std::max<proto::Duration>(*asked, *proto::exponential_backoff()({.count = ++patience.waits}));
  if (std::chrono::steady_clock::now() + wait > patience.until) return false;
  tell_why_waiting(explain(status, call));
  return sleep_unless_interrupted(wait);
}

void Farm::tell_why_waiting(const core::Error& error) {
  std::string reason = error.message;
  std::erase_if(reason, [](char c) { return c >= '0' && c <= '9'; });
  const std::lock_guard lock(mutex_);
  if (told_reasons_.insert(std::move(reason)).second) print_warning(error.message + "; trying again");
}

core::Error Farm::explain(const grpc::Status& status, const grpc::ClientContext& call) const {
  const bool answered = channel_->GetState(false) == GRPC_CHANNEL_READY;
  if (status.error_code() == grpc::StatusCode::UNAVAILABLE && !answered) return explain_unreachable(status);
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

// gRPC tells a handshake that failed from a peer that is not there in its text alone.
core::Error Farm::explain_unreachable(const grpc::Status& status) const {
  const proto::ClientSecurity& security = options_.security;
  const std::string& text = status.error_message();
  const auto says = [&](const char* words) { return text.find(words) != std::string::npos; };
  const auto unavailable = [](std::string sentence) {
    return core::Error{core::ErrorCode::kUnavailable, std::move(sentence)};
  };
  if (says("wrong version number"))
    return unavailable(fmt::format("the coordinator at {} speaks no TLS: leave out --tls-ca", address()));
  if (says("andshake")) {
    return unavailable(fmt::format(
        "{} answers, but this program does not trust it: is --tls-ca the authority of its certificate, and "
        "is that for this name? ({})",
        address(), text));
  }
  if (says("ocket closed") || says("reset by peer")) {
    const char* wants = "it speaks TLS and wants --tls-ca";
    if (!security.ca.empty()) wants = "it wants --tls-certificate and --tls-key";
    if (!security.certificate.empty()) wants = "it does not trust the authority of this --tls-certificate";
    return unavailable(fmt::format(
        "the coordinator at {} closed the connection: it has just been stopped, has as many as it takes "
        "(tessera-coordinator --max-connections), or {}",
        address(), wants));
  }
  return unavailable(fmt::format(
      "no coordinator answers at {}: start one with 'tessera-coordinator', or say where it is with "
      "--coordinator HOST:PORT or {}",
      address(), proto::kCoordinatorVariable));
}

}  // namespace tessera::client
