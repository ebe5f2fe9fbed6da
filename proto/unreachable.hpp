// SPDX-License-Identifier: Apache-2.0
// Explains why no coordinator can be reached. gRPC distinguishes a failed handshake, an unknown host name and
// a refused connection only in its message text. Stateless.
#pragma once

#include <grpcpp/support/status.h>

#include <string>

#include "core/base/error.hpp"
#include "proto/security.hpp"

namespace tessera::proto {

// Whether a call failed because no connection could be made.
bool is_no_connection(const grpc::Status& status);

// Whether the peer closed the connection before it accepted a call.
bool is_closed_at_once(const grpc::Status& status);

// Whether the failure is typical of a coordinator that is starting or stopping, or of a network that loses
// packets: the connection is refused, closed at once, or not answered in time.
bool may_be_starting(const grpc::Status& status);

// The reason, as far as it is known, and what to do: UNAVAILABLE. `address` and `security` are those of the
// channel.
core::Error explain_no_connection(const grpc::Status& status, const std::string& address,
                                  const ClientSecurity& security);

// The same for a coordinator that has answered before: lost_coordinator(), followed by the reason if it is
// known.
core::Error explain_loss(const grpc::Status& status, const std::string& address);
std::string lost_coordinator(const std::string& address);

}  // namespace tessera::proto
