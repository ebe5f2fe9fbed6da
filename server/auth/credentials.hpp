// SPDX-License-Identifier: Apache-2.0
// What a call shows to identify its caller. Stateless.
#pragma once

#include <grpcpp/server_context.h>

#include <string>

namespace tessera::auth {

struct Credentials {
  // The bearer token of the metadata. Empty if there is none.
  std::string token{};
  // The common name of the caller's certificate, which TLS has verified, in printable characters. Empty if
  // there is none, and if a token is shown, which counts alone.
  std::string certificate{};
};

Credentials shown_by(const grpc::CallbackServerContext& context);

}  // namespace tessera::auth
