// SPDX-License-Identifier: Apache-2.0
#include "proto/unreachable.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <initializer_list>
#include <string_view>
#include <utility>

#include "proto/channel.hpp"

namespace tessera::proto {
namespace {

bool says(const grpc::Status& status, std::initializer_list<std::string_view> any_of) {
  const std::string text = status.error_message();
  return std::any_of(any_of.begin(), any_of.end(),
                     [&](std::string_view words) { return text.find(words) != std::string::npos; });
}

// At its connection limits, a coordinator closes new connections without a message.
constexpr const char* kHasEnough =
    "has as many as it takes (tessera-coordinator --max-connections, --max-machine-connections)";

std::string closed_at_once(const std::string& address, const ClientSecurity& security) {
  const char* wants = "it speaks TLS and wants --tls-ca";
  if (!security.ca.empty()) wants = "it wants --tls-certificate and --tls-key";
  if (!security.certificate.empty()) wants = "it does not trust the authority of this --tls-certificate";
  return fmt::format("the coordinator at {} closed the connection: it is starting or stopping, {}, or it {}",
                     address, wants, kHasEnough);
}

std::string explain(const grpc::Status& status, const std::string& address, const ClientSecurity& security) {
  if (says(status, {"wrong version number"}))
    return fmt::format("the coordinator at {} speaks no TLS: leave out --tls-ca", address);
  if (says(status, {"not in peer certificate", "Hostname Verification Check failed"})) {
    return fmt::format(
        "{} answers, but its certificate is for other names: call it by one of those, or make a certificate "
        "for this one as well",
        address);
  }
  if (says(status, {"andshake failed"})) {
    return fmt::format(
        "{} answers, but this program does not trust it: is --tls-ca the authority of its certificate? ({})",
        address, status.error_message());
  }
  if (is_closed_at_once(status)) return closed_at_once(address, security);
  if (says(status, {"DNS resolution"}))
    return fmt::format("no machine is known by the name in {}: is it spelled right?", address);
  return fmt::format(
      "no coordinator answers at {}: start one with 'tessera-coordinator', or say where it is with "
      "--coordinator HOST:PORT or {}",
      address, kCoordinatorVariable);
}

}  // namespace

bool is_closed_at_once(const grpc::Status& status) {
  return says(status, {"ocket closed", "reset by peer"});
}

// gRPC shuts down an attempt to connect that has taken too long.
bool may_be_starting(const grpc::Status& status) {
  return is_no_connection(status) &&
         (says(status, {"onnection refused", "FD Shutdown", "handshaker shutdown"}) ||
          is_closed_at_once(status));
}

bool is_no_connection(const grpc::Status& status) {
  return status.error_code() == grpc::StatusCode::UNAVAILABLE &&
         says(status, {"failed to connect", "DNS resolution"});
}

core::Error explain_no_connection(const grpc::Status& status, const std::string& address,
                                  const ClientSecurity& security) {
  return {core::ErrorCode::kUnavailable, explain(status, address, security)};
}

std::string lost_coordinator(const std::string& address) {
  return fmt::format("lost the coordinator at {}", address);
}

core::Error explain_loss(const grpc::Status& status, const std::string& address) {
  std::string message = lost_coordinator(address);
  // Otherwise an existing connection was closed.
  if (is_no_connection(status) && is_closed_at_once(status))
    message += fmt::format(": it closed a new connection, since it is stopping or {}", kHasEnough);
  return {core::ErrorCode::kUnavailable, std::move(message)};
}

}  // namespace tessera::proto
