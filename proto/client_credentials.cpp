// SPDX-License-Identifier: Apache-2.0
#include "proto/client_credentials.hpp"

#include <utility>

#include "proto/certificates.hpp"

namespace tessera::proto {

ClientCredentials::ClientCredentials(std::shared_ptr<grpc::ChannelCredentials> credentials,
                                     std::shared_ptr<Certificates> certificates, std::string token_path,
                                     std::string token)
    : certificates_(std::move(certificates)),
      credentials_(std::move(credentials)),
      token_path_(std::move(token_path)),
      token_(std::move(token)) {}

core::Result<std::shared_ptr<ClientCredentials>> ClientCredentials::open(const std::string& address,
                                                                         const ClientSecurity& security) {
  auto token = read_token(security.token);
  if (!token) return core::fail(token.error());
  const auto fixed = proto::channel_credentials(address, security);
  if (!fixed) return core::fail(fixed.error());
  if (security.ca.empty()) {
    return std::shared_ptr<ClientCredentials>(
        new ClientCredentials(*fixed, nullptr, security.token, *std::move(token)));
  }
  const auto certificates = Certificates::open({security.certificate, security.key, security.ca});
  if (!certificates) return core::fail(certificates.error());
  return std::shared_ptr<ClientCredentials>(new ClientCredentials(
      (*certificates)->channel_credentials(), *certificates, security.token, *std::move(token)));
}

std::string ClientCredentials::token() const {
  const core::MutexLock lock(mutex_);
  return token_;
}

core::Status ClientCredentials::reload() {
  auto token = read_token(token_path_);
  if (!token) return core::fail(token.error());
  if (certificates_)
    if (auto done = certificates_->reload(); !done) return done;
  const core::MutexLock lock(mutex_);
  token_ = *std::move(token);
  return {};
}

}  // namespace tessera::proto
