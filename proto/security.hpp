// SPDX-License-Identifier: Apache-2.0
// How processes of a farm know one another: TLS with certificates from PEM files, and bearer tokens. On the
// loopback neither is needed; between machines, going without TLS must be asked for.
#pragma once

#include <grpcpp/security/credentials.h>
#include <grpcpp/security/server_credentials.h>

#include <memory>
#include <string>
#include <string_view>

#include "core/base/error.hpp"

namespace tessera::proto {

// Of a worker or a client. Files are PEM; empty paths are for what is not used.
struct ClientSecurity {
  std::string ca;                // who signed the coordinator's certificate; without it there is no TLS
  std::string certificate, key;  // to show a coordinator that asks for one; both or neither
  std::string token;             // file whose first line is shown to the coordinator with every call
  bool insecure = false;         // speak to other machines without TLS
};

// Of a coordinator.
struct ServerSecurity {
  std::string certificate, key;  // without them there is no TLS; both or neither
  std::string client_ca;  // who signed the certificates that callers must show; without it none is asked for
  bool insecure = false;  // be reachable from other machines without TLS
  // Be reachable from other machines by callers that show no certificate. They can use up the memory of the
  // HTTP/2 library, which reads what they send before any token is looked at.
  bool allow_unauthenticated = false;
};

// Whether HOST:PORT is reachable from this machine alone: "localhost" and loopback addresses, not names.
bool is_loopback(const std::string& address);

// Errors name the option or the file to mend.
core::Result<std::shared_ptr<grpc::ChannelCredentials>> channel_credentials(const std::string& address,
                                                                            const ClientSecurity& security);
core::Result<std::shared_ptr<grpc::ServerCredentials>> server_credentials(const std::string& address,
                                                                          const ServerSecurity& security);

// Whether a token may consist of this: letters, digits and -._~+/= (RFC 6750, b64token).
bool is_token(std::string_view text);

// The token in the file; empty without a path.
core::Result<std::string> read_token(const std::string& path);

// Under this key a call's metadata says "Bearer TOKEN" (RFC 6750).
inline constexpr const char* kTokenKey = "authorization";
inline constexpr const char* kTokenPrefix = "Bearer ";

}  // namespace tessera::proto
