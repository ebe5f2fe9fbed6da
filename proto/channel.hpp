// How processes of a farm reach each other: addresses, credentials, keepalive and limits, in this one place,
// where transport security will come as well. Thread-safe.
#pragma once

#include <grpcpp/channel.h>
#include <grpcpp/security/server_credentials.h>
#include <grpcpp/server_builder.h>

#include <memory>
#include <string>

namespace tessera::proto {

// Where a coordinator listens, and is looked for, unless told otherwise.
inline constexpr const char* kDefaultCoordinator = "127.0.0.1:7420";
// Names another one in the environment.
inline constexpr const char* kCoordinatorVariable = "TESSERA_COORDINATOR";

inline constexpr int kMaxMessageBytes = 64 << 20;

// A channel to the coordinator at HOST:PORT. Connects at its first call, and again whenever the connection is
// lost: a peer that vanished without a word is noticed within about 20 s, and a restarted one found within
// about 1 s, but only while a call with wait_for_ready waits for it. Between calls nothing drives the
// connection for up to 5 s.
std::shared_ptr<grpc::Channel> open_channel(const std::string& address);

std::shared_ptr<grpc::ServerCredentials> server_credentials();
// The same limits on the listening side, and leave for the clients' keepalive.
void apply_server_options(grpc::ServerBuilder& builder);

}  // namespace tessera::proto
