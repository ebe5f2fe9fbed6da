// SPDX-License-Identifier: Apache-2.0
#include "proto/channel.hpp"

#include <grpcpp/create_channel.h>
#include <grpcpp/resource_quota.h>
#include <grpcpp/support/client_interceptor.h>

#include <cstdlib>
#include <functional>
#include <utility>
#include <vector>

#include "proto/client_credentials.hpp"

namespace tessera::proto {
namespace {

constexpr int kKeepaliveTimeMs = 10'000;
constexpr int kKeepaliveTimeoutMs = 5'000;
// Well below the clients' period, since clocks differ.
constexpr int kMinPingIntervalMs = 5'000;
// No limit. By default gRPC stops after two pings without other data, and a client that only listens, as when
// it watches a job, would wait for ever for a peer that vanished.
constexpr int kPingsWithoutData = 0;

// The flow-control window: bytes that may be sent before the receiver has read them. Results and chunks of
// blobs fit into it. With a fixed window, gRPC need not send pings with each message to estimate it.
constexpr int kLookaheadBytes = 1 << 20;

namespace interception = grpc::experimental;

// Adds the token to a call's metadata. gRPC's own call credentials require TLS.
class ShowToken final : public interception::Interceptor {
 public:
  explicit ShowToken(std::string value) : value_(std::move(value)) {}

  void Intercept(interception::InterceptorBatchMethods* methods) override {
    if (methods->QueryInterceptionHookPoint(interception::InterceptionHookPoints::PRE_SEND_INITIAL_METADATA))
      methods->GetSendInitialMetadata()->emplace(kTokenKey, value_);
    methods->Proceed();
  }

 private:
  const std::string value_;
};

using CurrentToken = std::function<std::string()>;

class ShowTokenInEachCall final : public interception::ClientInterceptorFactoryInterface {
 public:
  explicit ShowTokenInEachCall(CurrentToken token) : token_(std::move(token)) {}

  interception::Interceptor* CreateClientInterceptor(interception::ClientRpcInfo*) override {
    return new ShowToken(kTokenPrefix + token_());  // gRPC deletes it with the call
  }

 private:
  const CurrentToken token_;
};

grpc::ChannelArguments channel_arguments() {
  grpc::ChannelArguments arguments;
  arguments.SetMaxReceiveMessageSize(kMaxMessageBytes);
  arguments.SetMaxSendMessageSize(kMaxMessageBytes);
  arguments.SetInt(GRPC_ARG_KEEPALIVE_TIME_MS, kKeepaliveTimeMs);
  arguments.SetInt(GRPC_ARG_KEEPALIVE_TIMEOUT_MS, kKeepaliveTimeoutMs);
  arguments.SetInt(GRPC_ARG_HTTP2_MAX_PINGS_WITHOUT_DATA, kPingsWithoutData);
  arguments.SetInt(GRPC_ARG_INITIAL_RECONNECT_BACKOFF_MS, 100);
  arguments.SetInt(GRPC_ARG_MIN_RECONNECT_BACKOFF_MS, 3'000);
  arguments.SetInt(GRPC_ARG_MAX_RECONNECT_BACKOFF_MS, 1'000);
  arguments.SetInt(GRPC_ARG_HTTP2_BDP_PROBE, 0);
  arguments.SetInt(GRPC_ARG_HTTP2_STREAM_LOOKAHEAD_BYTES, kLookaheadBytes);
  // Farms are private networks: addresses are used directly, whatever proxy the environment names.
  arguments.SetInt(GRPC_ARG_ENABLE_HTTP_PROXY, 0);
  return arguments;
}

// Without a token if `token` is empty.
std::shared_ptr<grpc::Channel> make_channel(const std::string& address,
                                            const std::shared_ptr<grpc::ChannelCredentials>& credentials,
                                            CurrentToken token) {
  std::vector<std::unique_ptr<interception::ClientInterceptorFactoryInterface>> interceptors;
  if (token) interceptors.push_back(std::make_unique<ShowTokenInEachCall>(std::move(token)));
  return interception::CreateCustomChannelWithInterceptors(address, credentials, channel_arguments(),
                                                           std::move(interceptors));
}

// Calls that announce a compression end with UNIMPLEMENTED before their message is read. Without the
// decompression filter, no other message is decompressed either.
void refuse_compression(grpc::ServerBuilder& builder) {
  builder.AddChannelArgument(GRPC_COMPRESSION_CHANNEL_ENABLED_ALGORITHMS_BITSET, 1 << GRPC_COMPRESS_NONE);
  builder.AddChannelArgument(GRPC_ARG_ENABLE_PER_MESSAGE_COMPRESSION, 0);
  builder.AddChannelArgument(GRPC_ARG_ENABLE_PER_MESSAGE_DECOMPRESSION, 0);
}

}  // namespace

void configure_grpc() {
  constexpr int kKeepWhatIsThere = 0;
  setenv("GRPC_VERBOSITY", "NONE", kKeepWhatIsThere);
  setenv("GRPC_CLIENT_CHANNEL_BACKUP_POLL_INTERVAL_MS", "100", kKeepWhatIsThere);
}

core::Result<std::shared_ptr<grpc::Channel>> open_channel(const std::string& address,
                                                          const ClientSecurity& security) {
  const auto credentials = channel_credentials(address, security);
  if (!credentials) return core::fail(credentials.error());
  const auto token = read_token(security.token);
  if (!token) return core::fail(token.error());
  if (token->empty()) return make_channel(address, *credentials, nullptr);
  return make_channel(address, *credentials, [token = *token] { return token; });
}

std::shared_ptr<grpc::Channel> open_channel(const std::string& address,
                                            const std::shared_ptr<const ClientCredentials>& credentials) {
  if (credentials->token().empty()) return make_channel(address, credentials->channel_credentials(), nullptr);
  return make_channel(address, credentials->channel_credentials(),
                      [credentials] { return credentials->token(); });
}

void apply_server_options(grpc::ServerBuilder& builder, const Patience& patience,
                          const ReceiveLimits& limits) {
  builder.SetMaxReceiveMessageSize(limits.message_bytes);
  builder.SetMaxSendMessageSize(kMaxMessageBytes);
  builder.SetResourceQuota(grpc::ResourceQuota("coordinator").Resize(limits.quota_bytes));
  builder.AddChannelArgument(GRPC_ARG_MAX_CONCURRENT_STREAMS, kMaxConcurrentStreams);
  refuse_compression(builder);
  const auto add_time = [&](const char* argument, std::chrono::milliseconds time) {
    builder.AddChannelArgument(argument, static_cast<int>(time.count()));
  };
  add_time(GRPC_ARG_SERVER_HANDSHAKE_TIMEOUT_MS, patience.handshake);
  add_time(GRPC_ARG_KEEPALIVE_TIME_MS, patience.ping_period);
  add_time(GRPC_ARG_KEEPALIVE_TIMEOUT_MS, patience.answer);
  // Also for clients without a call: a machine that vanished would keep its connection for ever.
  builder.AddChannelArgument(GRPC_ARG_KEEPALIVE_PERMIT_WITHOUT_CALLS, 1);
  builder.AddChannelArgument(GRPC_ARG_HTTP2_MAX_PINGS_WITHOUT_DATA, kPingsWithoutData);
  builder.AddChannelArgument(GRPC_ARG_HTTP2_MIN_RECV_PING_INTERVAL_WITHOUT_DATA_MS, kMinPingIntervalMs);
  builder.AddChannelArgument(GRPC_ARG_HTTP2_BDP_PROBE, 0);
  builder.AddChannelArgument(GRPC_ARG_HTTP2_STREAM_LOOKAHEAD_BYTES, kLookaheadBytes);
}

}  // namespace tessera::proto
