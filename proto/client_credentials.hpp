// SPDX-License-Identifier: Apache-2.0
// The credentials of a program that calls a coordinator for a long time, such as a worker: certificates and
// token can be replaced while channels use them. Thread-safe.
#pragma once

#include <memory>
#include <string>

#include "core/base/error.hpp"
#include "core/base/mutex.hpp"
#include "proto/security.hpp"

namespace tessera::proto {

class ClientCredentials {
 public:
  // For calls to this address. Errors: those of channel_credentials() and read_token().
  static core::Result<std::shared_ptr<ClientCredentials>> open(const std::string& address,
                                                               const ClientSecurity& security);

  // For channels that end before this object does.
  const std::shared_ptr<grpc::ChannelCredentials>& channel_credentials() const { return credentials_; }
  // Empty if the options name none.
  std::string token() const;

  // Reads the files again. The next calls carry the new token, and connections that begin some seconds later
  // use the new certificates; others go on. After an error, which names the file, nothing has changed.
  core::Status reload();

 private:
  ClientCredentials(std::shared_ptr<grpc::ChannelCredentials> credentials,
                    std::shared_ptr<Certificates> certificates, std::string token_path, std::string token);

  const std::shared_ptr<Certificates> certificates_;  // null without TLS
  const std::shared_ptr<grpc::ChannelCredentials> credentials_;
  const std::string token_path_;
  mutable core::Mutex mutex_;
  std::string token_ TESSERA_GUARDED_BY(mutex_);
};

}  // namespace tessera::proto
