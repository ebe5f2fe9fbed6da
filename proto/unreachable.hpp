// SPDX-License-Identifier: Apache-2.0
// What to tell whoever reaches no coordinator: gRPC tells a handshake that failed, or a name that nobody has,
// from a peer that is not there in its text alone. Stateless.
#pragma once

#include <grpcpp/support/status.h>

#include <string>

#include "core/base/error.hpp"
#include "proto/security.hpp"

namespace tessera::proto {

// Whether a call ended so because no connection could be made.
bool is_no_connection(const grpc::Status& status);

// Whether the other side closed the connection before it took a call.
bool is_closed_at_once(const grpc::Status& status);

// Whether it ended so as with a coordinator that is starting or stopping: nobody listens, or the connection
// is closed at once.
bool may_be_starting(const grpc::Status& status);

// Why not, as far as it shows, and what to mend: UNAVAILABLE. `address` and `security` are those that the
// channel was opened with.
core::Error explain_no_connection(const grpc::Status& status, const std::string& address,
                                  const ClientSecurity& security);

// The same of a coordinator that has answered before: what begins with lost_coordinator() and says why, where
// that shows.
core::Error explain_loss(const grpc::Status& status, const std::string& address);
std::string lost_coordinator(const std::string& address);

}  // namespace tessera::proto
