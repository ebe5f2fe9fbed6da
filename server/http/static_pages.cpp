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

http::Response serve_page(const http::Request& request) {
  if (request.method != "GET") {
    http::Response response = text_with_headers(405, "this path can only be read");
    response.headers.emplace_back("Allow", "GET");
    return response;
  }
  // The coordinator serves HTTP only while it serves everything else.
  if (request.path == "/healthz" || request.path == "/readyz") return text_with_headers(200, "ok");
  if (auto page = view::page_response(request)) return std::move(*page);
  return text_with_headers(404, "there is no such page");
}

}  // namespace tessera::http_api
