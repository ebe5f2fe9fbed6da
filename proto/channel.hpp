// SPDX-License-Identifier: Apache-2.0
// How processes of a farm reach each other: addresses, keepalive and limits. Thread-safe.
#pragma once

#include <grpcpp/channel.h>
#include <grpcpp/server_builder.h>

#include <chrono>
#include <cstddef>
#include <memory>
#include <string>

#include "proto/security.hpp"

namespace tessera::proto {

// Where a coordinator listens, and is looked for, unless told otherwise.
inline constexpr const char* kDefaultCoordinator = "127.0.0.1:7420";
// Names another one in the environment.
inline constexpr const char* kCoordinatorVariable = "TESSERA_COORDINATOR";

inline constexpr int kMaxMessageBytes = 64 << 20;

// A channel to the coordinator at HOST:PORT. Connects at its first call, and again whenever the connection is
// lost: a peer that vanished without a word is noticed within about 15 s, and a restarted one found within
// about 1 s, but only while a call with wait_for_ready waits for it. Between calls nothing drives the
// connection for up to 5 s. Every call shows the token, if there is one. Errors: those of
// channel_credentials() and read_token().
core::Result<std::shared_ptr<grpc::Channel>> open_channel(const std::string& address,
                                                          const ClientSecurity& security = {});

// How long a coordinator waits for who has connected.
struct Patience {
  // Until the connection is ready for calls, TLS included. open_channel() gives up sooner.
  std::chrono::milliseconds handshake = std::chrono::seconds(10);
  // How often it asks whether they are there, and how long it waits for an answer to that, or to what it
  // sent.
  std::chrono::milliseconds ping_period = std::chrono::seconds(10);
  std::chrono::milliseconds answer = std::chrono::seconds(5);
};

// Calls that one connection may have under way. Clients queue further ones.
inline constexpr int kMaxConcurrentStreams = 100;

// How much a coordinator receives.
struct ReceiveLimits {
  int message_bytes = kMaxMessageBytes;
  // Memory of all connections, calls and messages while they are received. gRPC cancels calls, and closes
  // connections, where more would be needed.
  std::size_t quota_bytes = std::size_t{1} << 30;
};

// The listening side: the clients' keepalive is permitted, and what may come is limited. Compressed messages
// are refused: one of a megabyte could hold a gigabyte.
void apply_server_options(grpc::ServerBuilder& builder, const Patience& patience = {},
                          const ReceiveLimits& limits = {});

}  // namespace tessera::proto
