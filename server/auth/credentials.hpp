// SPDX-License-Identifier: Apache-2.0
// What a call shows to identify its caller. Pure functions.
#pragma once

#include <grpcpp/server_context.h>

#include <string>
#include <string_view>

namespace tessera::auth {

struct Credentials {
  // The bearer token. Empty if there is none.
  std::string token{};
  // digest_of_token() of a token that was shown earlier, and stands for it. Empty if there is none.
  std::string token_digest{};
  // The common name of the caller's certificate, which TLS has verified, in printable characters. Empty if
  // there is none, and if a token is shown, which counts alone.
  std::string certificate{};
};

// The SHA-256 of a token, in hexadecimal digits.
std::string digest_of_token(const std::string& token);
// The token of an Authorization header "Bearer TOKEN"; empty if it has another form.
std::string bearer_token(std::string_view header);

Credentials shown_by(const grpc::CallbackServerContext& context);

}  // namespace tessera::auth
