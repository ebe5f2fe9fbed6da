// SPDX-License-Identifier: Apache-2.0
// Connections between the processes of a farm: addresses, keepalive and limits. Thread-safe.
#pragma once

#include <grpcpp/channel.h>
#include <grpcpp/server_builder.h>

#include <chrono>
#include <cstddef>
#include <memory>
#include <string>

#include "proto/security.hpp"

namespace tessera::proto {

class ClientCredentials;

// The default address of a coordinator.
inline constexpr const char* kDefaultCoordinator = "127.0.0.1:7420";
// The environment variable that overrides it.
inline constexpr const char* kCoordinatorVariable = "TESSERA_COORDINATOR";

inline constexpr int kMaxMessageBytes = 64 << 20;

// Sets what gRPC reads from the environment, unless that has it: programs call it first. gRPC logs nothing,
// since errors are reported once, by our own messages (GRPC_VERBOSITY=DEBUG turns its log on), and connects
// between calls, too: by default it looks at such a connection every 5 s, later than the handshake of TLS
// times out.
void configure_grpc();

// A channel to the coordinator at HOST:PORT. Connects with the first call, and again whenever the connection
// is lost. A peer that vanished is detected within about 15 s, and a restarted one within about 1 s. Every
// call carries the token, if there is one. Errors: those of channel_credentials() and read_token().
core::Result<std::shared_ptr<grpc::Channel>> open_channel(const std::string& address,
                                                          const ClientSecurity& security = {});

// The same with credentials that can be read again while the channel is used. They must outlive it.
std::shared_ptr<grpc::Channel> open_channel(const std::string& address,
                                            const std::shared_ptr<const ClientCredentials>& credentials);

// The timeouts of a coordinator for its connections.
struct Patience {
  // Until the connection is ready for calls, TLS included. open_channel() gives up earlier.
  std::chrono::milliseconds handshake = std::chrono::seconds(10);
  // The keepalive period, and the time to wait for an acknowledgement of a ping or of sent data.
  std::chrono::milliseconds ping_period = std::chrono::seconds(10);
  std::chrono::milliseconds answer = std::chrono::seconds(5);
};

// The calls that one connection may have in progress. Clients queue further ones.
inline constexpr int kMaxConcurrentStreams = 100;

// The limits on what a coordinator receives.
struct ReceiveLimits {
  int message_bytes = kMaxMessageBytes;
  // The memory of all connections, calls and messages while they are received. gRPC cancels calls and closes
  // connections that would exceed it.
  std::size_t quota_bytes = std::size_t{1} << 30;
};

// Configures the server: permits the clients' keepalive and applies the limits. Compressed messages are
// rejected, since one of a megabyte could hold a gigabyte.
void apply_server_options(grpc::ServerBuilder& builder, const Patience& patience = {},
                          const ReceiveLimits& limits = {});

}  // namespace tessera::proto
