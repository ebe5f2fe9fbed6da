// SPDX-License-Identifier: Apache-2.0
#include "server/http/static_pages.hpp"

#include <string>
#include <utility>

#include "core/view/page.hpp"
#include "core/view/security_headers.hpp"
#include "server/http/answers.hpp"

namespace tessera::http_api {

namespace {

http::Response text_with_headers(int status, const std::string& text) {
  http::Response response = text_response(status, text);
  view::add_security_headers(response);
  return response;
}

}  // namespace

http::Response serve_page(const http::Request& request, const rpc::Readiness& readiness) {
  if (request.method != "GET") {
    http::Response response = text_with_headers(405, "this path can only be read");
    response.headers.emplace_back("Allow", "GET");
    return response;
  }
  if (request.path == "/healthz") return text_with_headers(200, "ok");
  if (request.path == "/readyz") {
    const core::Status ready = readiness.status();
    return ready ? text_with_headers(200, "ok") : text_with_headers(503, ready.error().message);
  }
  if (auto page = view::page_response(request)) return std::move(*page);
  return text_with_headers(404, "there is no such page");
}

}  // namespace tessera::http_api
