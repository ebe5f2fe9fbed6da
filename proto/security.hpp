// SPDX-License-Identifier: Apache-2.0
// Authentication in a farm: TLS with certificates from PEM files, and bearer tokens. The loopback needs
// neither; between machines, an option must permit plain connections.
#pragma once

#include <grpcpp/security/credentials.h>
#include <grpcpp/security/server_credentials.h>

#include <memory>
#include <string>
#include <string_view>

#include "core/base/error.hpp"

namespace tessera::proto {

class Certificates;

// The credentials of a worker or a client. Files are PEM; an empty path means that the file is not used.
struct ClientSecurity {
  std::string ca{};                  // the CA of the coordinator's certificate; without it there is no TLS
  std::string certificate{}, key{};  // for a coordinator that requests a certificate; both or neither
  std::string token{};               // file whose first line is sent with every call
  bool insecure = false;             // permits connections to other machines without TLS
};

// The credentials of a coordinator.
struct ServerSecurity {
  std::string certificate, key;  // without these there is no TLS; both or neither
  std::string client_ca;         // the CA of callers' certificates; if empty, none are requested
  bool insecure = false;         // permits connections from other machines without TLS
  // Permits callers from other machines without certificates. They can exhaust the memory of the HTTP/2
  // library, which reads their data before any token is checked.
  bool allow_unauthenticated = false;
};

// Whether HOST:PORT is reachable only from this machine: "localhost" and loopback addresses, not other names.
bool is_loopback(const std::string& address);

// Errors name the option or the file to correct.
core::Result<std::shared_ptr<grpc::ChannelCredentials>> channel_credentials(const std::string& address,
                                                                            const ClientSecurity& security);

struct ServerCredentials {
  std::shared_ptr<grpc::ServerCredentials> credentials;
  // Must outlive the server. Null without TLS.
  std::shared_ptr<Certificates> certificates{};
};
core::Result<ServerCredentials> server_credentials(const std::string& address,
                                                   const ServerSecurity& security);

// Whether the text has only the characters of a token: letters, digits and -._~+/= (RFC 6750, b64token).
bool is_token(std::string_view text);

// The token in the file; empty if the path is empty.
core::Result<std::string> read_token(const std::string& path);

// The metadata of a call has "Bearer TOKEN" under this key (RFC 6750).
inline constexpr const char* kTokenKey = "authorization";
inline constexpr const char* kTokenPrefix = "Bearer ";

}  // namespace tessera::proto
