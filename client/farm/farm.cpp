#include "client/farm/farm.hpp"

#include <fmt/format.h>

#include <utility>

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

core::Error Farm::explain(const grpc::Status& status) const {
  const bool answered = channel_->GetState(false) == GRPC_CHANNEL_READY;
  if (status.error_code() == grpc::StatusCode::UNAVAILABLE && !answered) return explain_unreachable(status);
  if (status.error_code() == grpc::StatusCode::DEADLINE_EXCEEDED)
    return {core::ErrorCode::kDeadlineExceeded,
            fmt::format("the coordinator at {} did not answer in time: try again, or look at its log",
                        address())};
  return proto::error_from_grpc(status);
}

// gRPC tells no handshake that failed from a peer that is not there, but in its text.
core::Error Farm::explain_unreachable(const grpc::Status& status) const {
  const std::string& text = status.error_message();
  if (text.find("andshake") != std::string::npos) {
    return {
        core::ErrorCode::kUnavailable,
        fmt::format(
            "{} answers, but it and this program do not trust each other: is --tls-ca the authority of its "
            "certificate, and is that for this name? ({})",
            address(), text)};
  }
  if (text.find("ocket closed") != std::string::npos || text.find("reset by peer") != std::string::npos) {
    return {core::ErrorCode::kUnavailable,
            fmt::format(
                "the coordinator at {} closed the connection: it has just been stopped, or it speaks TLS and "
                "wants {}",
                address(), options_.security.ca.empty() ? "--tls-ca" : "--tls-certificate and --tls-key")};
  }
  return {core::ErrorCode::kUnavailable,
          fmt::format(
              "no coordinator answers at {}: start one with 'tessera-coordinator', or say where it is with "
              "--coordinator HOST:PORT or {}",
              address(), proto::kCoordinatorVariable)};
}

}  // namespace tessera::client
