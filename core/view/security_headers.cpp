// SPDX-License-Identifier: Apache-2.0
#include "core/view/security_headers.hpp"

#include <string>

#include "core/base/host_port.hpp"

namespace tessera::view {
namespace {

constexpr const char* kContentSecurityPolicy =
    "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' blob: data:; connect-src "
    "'self'; "
    "form-action 'self'; frame-ancestors 'none'; base-uri 'none'";

}  // namespace

void add_security_headers(http::Response& response) {
  response.headers.emplace_back("Content-Security-Policy", kContentSecurityPolicy);
  response.headers.emplace_back("Referrer-Policy", "no-referrer");
  response.headers.emplace_back("Cross-Origin-Opener-Policy", "same-origin");
  add_resource_headers(response);
}

void add_resource_headers(http::Response& response) {
  response.headers.emplace_back("X-Content-Type-Options", "nosniff");
  response.headers.emplace_back("Cross-Origin-Resource-Policy", "same-origin");
}

bool is_local_host(std::string_view host) {
  const std::string text(host);
  return core::parse_host_port(text).has_value() || core::parse_host_port(text + ":80").has_value();
}

}  // namespace tessera::view
