// SPDX-License-Identifier: Apache-2.0
#include "server/auth/credentials.hpp"

#include <grpc/grpc_security_constants.h>

#include <algorithm>
#include <cctype>
#include <string_view>

#include "core/base/printable.hpp"
#include "proto/blob.hpp"
#include "proto/security.hpp"

namespace tessera::auth {
namespace {

std::string token_of(const grpc::CallbackServerContext& context) {
  const auto found = context.client_metadata().find(proto::kTokenKey);
  if (found == context.client_metadata().end()) return {};
  return bearer_token({found->second.data(), found->second.size()});
}

// gRPC has this property only of certificates that it verified.
std::string certificate_of(const grpc::CallbackServerContext& context) {
  const auto connection = context.auth_context();
  if (!connection) return {};
  const auto names = connection->FindPropertyValues(GRPC_X509_CN_PROPERTY_NAME);
  return names.empty() ? std::string() : core::printable(std::string(names[0].data(), names[0].size()));
}

}  // namespace

std::string digest_of_token(const std::string& token) {
  return proto::digest_of(token).hex();
}

// The scheme is case-insensitive (RFC 7235, 2.1).
std::string bearer_token(std::string_view header) {
  const std::string_view prefix = proto::kTokenPrefix;
  const bool is_bearer = std::equal(
      prefix.begin(), prefix.end(), header.begin(), header.begin() + std::min(prefix.size(), header.size()),
      [](char a, char b) {
        return std::tolower(static_cast<unsigned char>(a)) == std::tolower(static_cast<unsigned char>(b));
      });
  return is_bearer ? std::string(header.substr(prefix.size())) : std::string();
}

Credentials shown_by(const grpc::CallbackServerContext& context) {
  Credentials shown{.token = token_of(context)};
  if (shown.token.empty()) shown.certificate = certificate_of(context);
  return shown;
}

}  // namespace tessera::auth
