// SPDX-License-Identifier: Apache-2.0
#include "server/http/origin.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <string_view>

#include "core/base/printable.hpp"
#include "core/view/security_headers.hpp"

namespace tessera::http_api {

namespace {

core::Status refuse(std::string why) {
  return core::fail(core::ErrorCode::kPermissionDenied, std::move(why));
}

std::string lower(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(),
                 [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; });
  return text;
}

// Empty if it is no origin of the web.
std::string authority_of(std::string_view origin, bool is_secure) {
  constexpr std::string_view kPlain = "http://", kSecure = "https://";
  if (origin.starts_with(kSecure)) return std::string(origin.substr(kSecure.size()));
  // A page that came without TLS may be anybody's.
  if (origin.starts_with(kPlain) && !is_secure) return std::string(origin.substr(kPlain.size()));
  return {};
}

}  // namespace

std::string host_of(const std::string& host_and_port) {
  const std::size_t colon = host_and_port.rfind(':');
  const std::size_t bracket = host_and_port.rfind(']');
  const bool has_port = colon != std::string::npos && (bracket == std::string::npos || bracket < colon);
  return has_port ? host_and_port.substr(0, colon) : host_and_port;
}

core::Status check_origin(const http::Request& request) {
  if (request.header(kChangeHeader).empty())
    return refuse("a change needs the header 'X-Tessera: 1', so that pages of other sites cannot make it");
  if (!request.headers.contains("origin")) return {};
  const std::string origin = request.header("origin");
  const std::string authority = authority_of(origin, request.is_secure);
  if (!authority.empty() && lower(authority) == lower(request.header("host"))) return {};
  return refuse(fmt::format(
      "a page of {} may make no changes here; a reverse proxy must pass on the header Host unchanged",
      core::printable(origin)));
}

core::Status check_host(const http::Request& request, const std::string& own_host) {
  if (!request.headers.contains("host")) return {};  // no browser
  if (view::is_local_host(request.header("host"))) return {};
  const std::string host = lower(host_of(request.header("host")));
  if (host == "localhost" || host == lower(own_host)) return {};
  return refuse(
      fmt::format("'{}' is no name of this coordinator: use localhost or its address, or start it "
                  "with --http {}:PORT",
                  core::printable(host), core::printable(host)));
}

}  // namespace tessera::http_api
